"""The network: the seam `Transport` with its implementations, and which domain and range they join.

`opening.open_transport` opens one, with the settings of `domain.read_settings`.
"""

"""The network: the seam `Transport` with its implementations, and which domain and range they join."""

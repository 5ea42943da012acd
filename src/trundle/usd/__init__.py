"""Writing worlds as USD stages, and the additions that Isaac Sim needs. `worlds.usd` reads stages."""

TIMESTEP = 0.005
"""Length of a physics step [s]: the same as in the other simulators, so that limits have the same effect."""

GROUND_OFFSET = 0.02
"""Initial height of the robot above z = 0 [m]: one that starts in the floor falls through it."""

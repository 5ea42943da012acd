"""How a robot is simulated in Isaac Sim: what its stages are written with, and its simulator steps by."""

TIMESTEP = 0.005
"""Length of a physics step [s]: the same as in the other simulators, so that limits act alike."""

GROUND_OFFSET = 0.02
"""Height [m] above z = 0 that the robot is put at: one that starts in the floor falls through it."""

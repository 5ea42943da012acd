"""The simulated time on the network, the state of the simulation, and the services that control it."""

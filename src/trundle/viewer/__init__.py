"""Pictures and windows in 3D. Nothing here imports the engine until one of its modules is used."""

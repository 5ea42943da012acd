"""MuJoCo as a simulator. Nothing here imports the engine until one of its modules is used."""

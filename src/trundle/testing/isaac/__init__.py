"""Scripts for Isaac Sim, run on NVIDIA's own 6.2 Python classes and PhysX on the CPU, without the application.

`python -m trundle.testing.isaac SCRIPT` runs a script unmodified. World, WheeledRobot, Articulation,
DifferentialController, SimulationManager and the stage utilities are NVIDIA's, from its wheels; the physics is
PhysX. What lies between them in Isaac Sim, the Kit application, is stood in for by the modules of this package:

- `kit`, `events`: the application, its loop, timeline, events and settings (`isaacsim.SimulationApp`, `carb`,
  `omni.kit.app`);
- `stage`: the open stage (`omni.usd`), the schemas' Python classes (`pxr.PhysxSchema`) and Fabric (`usdrt`);
- `interfaces`, `scenes`: PhysX' callbacks and contact report (`omni.physics.core`, `omni.physx`), and the compiled part
  of the simulation manager; `physics` runs PhysX itself, and `poses` keeps bodies of both in one place;
- `tensors`: views of articulations and bodies (`omni.physics.tensors`);
- `nothing`: everything else of `carb` and `omni`, which does nothing; the runner lists what was called of it.

It renders nothing: there is no camera, window or sensor.
"""

"""Step 2 of 5: list the robot's joints, and which ones are driven.

`list_joints` also takes the path of an MJCF or URDF file: list_joints("my_robot.urdf").
"""

import trundle
from trundle.sim.mujoco import list_joints

for joint in list_joints(trundle.Robot.load("nova_carter")):
    limits = "free" if joint.limits is None else f"{joint.limits[0]:g} to {joint.limits[1]:g}"
    drives = "  <- drives" if joint.drives else ""
    print(f"{joint.name:<24} {joint.type:<8} {joint.parent} -> {joint.child}  {limits}{drives}")

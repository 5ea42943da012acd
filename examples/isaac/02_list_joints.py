"""Step 2 of 5 in Isaac Sim: list the robot's joints, and which ones are driven.

./python.sh examples/isaac/02_list_joints.py
"""

import trundle
from trundle.sim.isaac import IsaacSimulator

robot = trundle.Robot.load("nova_carter")
wheels = (robot.drive.left_joint, robot.drive.right_joint)
with IsaacSimulator(trundle.World(name="floor", solids=()), robot, headless=True) as sim:
    for index, name in enumerate(sim.joint_names()):
        print(index, name, "<- drives" if name in wheels else "")

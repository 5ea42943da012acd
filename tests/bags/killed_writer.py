"""Records a made-up run in real time until it is killed; prints the time of each step that was recorded."""

import sys
import time

from trundle.bags import Recorder
from trundle.geometry import Pose2D, Twist2D
from trundle.mission import RunInfo, Step
from trundle.navigation import NavigationStatus
from trundle.observation import Observation
from trundle.robots import Robot, WheelSpeeds
from trundle.sim import RobotState

path, pace = sys.argv[1], float(sys.argv[2])
robot = Robot.load("turtlebot3_burger")
recorder = Recorder(path)
recorder.on_start(RunInfo("killed", robot, None, Pose2D(0.0, 0.0), (), 0.0, float("inf"), 0.05, "none", "script", 0))
for index in range(100_000):
    now, pose = 0.05 * index, Pose2D(0.01 * index, 0.0)
    state = RobotState(now, pose, Twist2D(0.2, 0.0), WheelSpeeds(0.0, 0.0), WheelSpeeds(0.0, 0.0), pose)
    seen = Observation(now, state.twist, pose)
    recorder.on_step(Step(index, state, state.twist, 0, None, NavigationStatus.DRIVING, state.twist, seen))
    sys.stdout.write(f"{now:.3f}\n")
    sys.stdout.flush()
    time.sleep(0.05 / pace)

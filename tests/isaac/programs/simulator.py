"""trundle's IsaacSimulator in a room: drives, a reset, contacts, and a start inside a wall; prints one line of JSON."""

import json

import trundle
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.sim import simulate
from trundle.worlds import World

PERIOD = 0.05
room = World("room", (Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((3.0, 0.0, 0.5))),))
robot = trundle.Robot.load("nova_carter")


def drive(simulator, v, w, steps=100):
    simulator.reset(Pose2D(-1.0, 0.5, 0.3))
    states = [simulator.step(Twist2D(v, w), PERIOD) for _ in range(steps)]
    return {
        "pose": states[-1].pose.as_tuple(),
        "odometry": states[-1].odometry.as_tuple(),
        "twist": [states[-1].twist.v, states[-1].twist.w],
        "speeds": list(states[-1].wheel_speeds),
        "time": states[-1].time,
        "contacts": [contact.other for state in states for contact in state.contacts],
    }


commands = {"straight": (0.4, 0.0), "turn": (0.0, 0.7), "curve": (0.25, -0.5)}
with simulate(World("empty", ()), robot, backend="kinematic", lidar=False) as kinematic:
    expected = {name: drive(kinematic, *command) for name, command in commands.items()}
with simulate(room, robot, backend="isaac", headless=True) as simulator:
    found = {name: drive(simulator, *command) for name, command in commands.items()}
    again = drive(simulator, *commands["curve"])
    still = drive(simulator, 0.0, 0.0, 20)
    simulator.reset(Pose2D(2.0, 0.0))
    touched = None
    for _ in range(100):
        state = simulator.step(Twist2D(0.5, 0.0), PERIOD)
        if state.contacts:
            touched = [state.time, sorted({contact.other for contact in state.contacts}), state.contacts[0].x]
            break
    inside = simulator.reset(Pose2D(2.8, 0.0))
    report = {
        "generation": simulator.application.generation,
        "joints": simulator.joint_names(),
        "expected": expected,
        "found": found,
        "again": again,
        "still": still,
        "touched": touched,
        "inside": [sorted({contact.other for contact in inside.contacts}), inside.pose.as_tuple()],
    }
print(json.dumps(report))

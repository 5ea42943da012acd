"""`Run`: a navigator that drives in a room with a lidar."""

from support.sensed_rooms import GOAL, ROBOT, START
from trundle.navigation.state import FINAL
from trundle.sim import simulate


class Run:
    """A navigator that drives in a world, with what was seen on the way."""

    def __init__(
        self, world, navigator, start=START, goal=GOAL, *, seconds=90.0, change=None, backend="kinematic", robot=ROBOT
    ):
        self.statuses, self.messages, self.poses, self.contact = [], [], [], ""
        self.speeds, self.timed = [], []
        navigator.set_goal(goal)
        sim = simulate(world, robot, backend=backend, lidar=True)
        with sim:
            state = sim.reset(start)
            for _ in range(round(seconds / navigator.dt)):
                scans = state.scans if change is None else change(state)
                command = navigator.update(state.pose, state.twist, time=state.time, scans=scans)
                self.poses.append(state.pose)
                self.timed.append((state.pose, state.time))
                self.speeds.append(state.twist.v)
                if not self.statuses or navigator.status is not self.statuses[-1]:
                    self.statuses.append(navigator.status)
                if navigator.message and (not self.messages or navigator.message != self.messages[-1]):
                    self.messages.append(navigator.message)
                if navigator.status in FINAL:
                    break
                state = sim.step(command, navigator.dt)
                if state.contacts:
                    self.contact = state.contacts[0].other
                    break
        self.time, self.pose = state.time, state.pose

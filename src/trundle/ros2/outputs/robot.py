"""`RobotOutputs`: publishes the robot, its sensors and the clock of every run; an observer."""

from __future__ import annotations

from trundle.mission import Episode, RunInfo, Step
from trundle.ros2.outputs.clock import ClockOutput
from trundle.ros2.outputs.contacts import ContactOutput
from trundle.ros2.outputs.fixed import publish_description, publish_static_frames
from trundle.ros2.outputs.lidar import LidarOutput
from trundle.ros2.outputs.motion import JointOutput, MotionOutput
from trundle.ros2.outputs.output import Output
from trundle.ros2.role import BridgeContext
from trundle.sim import Substep

FASTEST = 10.0
"""How fast a run may pass, relative to real time, for /clock to come from its physics steps."""


class RobotOutputs:
    """Publishes what a simulator of the robot publishes; only what is wanted is made.

    A run that passes more than ten times as fast as real time has /clock once in each control period, which is 500
    times a second at least: more helps nobody, and slows the run.

    Args:
        context: The bridge.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._context = context
        self._is_fast = False
        wire, profile, topics = context.wire, context.profile, context.profile.topics
        robot = context.mission.robot
        self._ticks_joints = False
        self._clock = (
            None if topics.clock is None else ClockOutput(wire, topics.clock, context.clock, profile.clock_rate)
        )
        self._joints = None if topics.joint_states is None else JointOutput(context, topics.joint_states)
        outputs: list[Output | None] = [self._clock, MotionOutput(context), self._joints]
        outputs += [
            LidarOutput(context, name, robot.lidars[name], sensor) for name, sensor in profile.sensors_of(robot).items()
        ]
        if topics.contacts is not None:
            outputs.append(ContactOutput(context, topics.contacts))
        self._outputs: list[Output] = [output for output in outputs if output is not None]
        if profile.publishes_static and topics.tf_static is not None:
            publish_static_frames(context, topics.tf_static)
        if topics.robot_description is not None:
            publish_description(context, topics.robot_description)

    def on_start(self, run: RunInfo) -> None:
        """Let the clock and the odometry begin."""
        self._context.clock.begin()
        self._context.origin = run.start
        self._ticks_joints = self._context.profile.joint_state_rate * run.dt > 1.0 + 1e-9
        self._context.periods.runs += 1

    def on_step(self, step: Step) -> None:
        """Publish a control period."""
        time = self._context.clock.set(step.state.time)
        self._is_fast = self._context.driver.status.factor > FASTEST
        for output in self._outputs:
            output.publish(step, time)
        if step.index:
            self._context.periods.add()

    def on_substep(self, substep: Substep) -> None:
        """Publish the time of a physics step, and joint states that come more often than control periods."""
        time = self._context.clock.set(substep.time)
        if self._clock is not None and not self._is_fast:
            self._clock.tick(time)
        positions, speeds = substep.wheel_positions, substep.wheel_speeds
        if self._ticks_joints and self._joints is not None and positions is not None and speeds is not None:
            self._joints.tick(time, positions, speeds)

    def on_end(self, episode: Episode) -> None:
        """Do nothing: the next run may follow."""

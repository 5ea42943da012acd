"""What the navigator publishes of its localizer: map → odom, the pose, the particles, and what it says of them."""

from __future__ import annotations

import math

import numpy as np

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.messages.makers import DIAGNOSTICS, PARTICLE_CLOUD, POSE, encode_particles, learn_particle_cloud
from trundle.messages.qos import LATCHED, SENSOR, TRANSFORMS, Qos
from trundle.mission import Step
from trundle.navigation import NavigationStatus
from trundle.observation import LocalizationState, describe_state
from trundle.ros2.navigator_role.context import Kit
from trundle.ros2.outputs.motion import EXACT
from trundle.ros2.outputs.output import Cadence
from trundle.ros2.wire import Outlet, Wire

TOLERANCE_S = 0.1
"""map → odom is stamped so far ahead [s], as AMCL does: it then holds for odometry that comes before the next one."""

MOVED_M, TURNED_RAD = 0.25, 0.2
"""AMCL's update_min_d and update_min_a: the pose is published after this."""

PARTICLES_PERIOD_S = 0.2
"""Particles are published at most this often: whoever draws them sees no more."""

_WARN, _ERROR = 1, 2
"""Levels of diagnostic_msgs/DiagnosticStatus."""

_GIVEN_UP = (NavigationStatus.STUCK, NavigationStatus.NO_PATH, NavigationStatus.PLANNING_TIMED_OUT)

STATE_PERIOD_S = 1.0
"""The state is published where it changes, and this often, as diagnostics are."""


class PoseOutput:
    """Publishes map → odom, and the pose as AMCL does: when the robot has moved, or it was told its pose.

    It is also published when the localizer's state changes.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        context = kit.context
        self._kit = kit
        self._odom = context.wire.names.frame(context.profile.frames.odom)
        self._tf = context.wire.outlet(context.profile.topics.tf, "tf2_msgs/msg/TFMessage", TRANSFORMS)
        self._pose = context.wire.outlet("amcl_pose", POSE, LATCHED)
        self._last: Pose2D | None = None
        self._state: LocalizationState = "localized"
        self._covariance = self._exact = np.diag([EXACT] * 3)

    def begin(self) -> None:
        """Forget the last pose: a run begins."""
        self._last, self._covariance = None, self._exact

    def publish(self, step: Step, time: float) -> None:
        """Publish what the robot believes at the end of a control period."""
        kit, belief = self._kit, self._kit.beliefs.now
        if self._tf.is_wanted:
            stamp = time + TOLERANCE_S
            transform = kit.make.transform(stamp, kit.map_frame, self._odom, belief.map_odom)
            self._tf.write(kit.make.transforms([transform]))
        last, pose, state = self._last, belief.pose, self._state
        if step.estimate is not None:
            known, state = step.estimate.covariance, step.estimate.state
            self._covariance = known if known is not None and known.any() else self._exact
        turned = math.inf if last is None else abs(wrap_angle(pose.yaw - last.yaw))
        if last is None or pose.distance_to(last) >= MOVED_M or turned >= TURNED_RAD or state != self._state:
            self._publish_pose()
        self._state = state

    def answer(self) -> None:
        """Publish the pose now, and after the next control period: the robot was told where it is."""
        self._publish_pose()
        self._last = None

    def _publish_pose(self) -> None:
        kit, belief = self._kit, self._kit.beliefs.now
        self._last = belief.pose
        self._pose.write(kit.make.pose_estimate(belief.time, belief.pose, self._covariance, kit.map_frame))


class ParticleOutput:
    """Publishes the particles as AMCL does, while somebody listens; nothing where the other side lacks nav2_msgs.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit
        wire, has_localizer = kit.context.wire, kit.context.mission.scenario.localizer is not None
        writes = has_localizer and _can_write(wire)
        self._outlet = wire.outlet("particle_cloud", PARTICLE_CLOUD, SENSOR) if writes else None
        self._cadence = Cadence(PARTICLES_PERIOD_S)
        self._shown: FloatArray | None = None

    def publish(self, step: Step, time: float) -> None:
        """Publish the particles, if there are new ones and it is due."""
        outlet, estimate = self._outlet, step.estimate
        if outlet is None or not outlet.is_wanted or estimate is None or estimate.particles is None:
            return
        if estimate.particles is not self._shown and self._cadence.is_due(time):
            self._shown = estimate.particles
            self._cadence.mark(time)
            outlet.write_bytes(encode_particles(self._kit.make, time, estimate.particles, self._kit.map_frame))


class StateOutput:
    """Publishes what the localizer says of its estimate on /diagnostics: localized, ambiguous or lost.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit
        has_localizer = kit.context.mission.scenario.localizer is not None
        wire = kit.context.wire
        self._outlet: Outlet | None = wire.outlet("/diagnostics", DIAGNOSTICS, Qos(10)) if has_localizer else None
        self._cadence = Cadence(STATE_PERIOD_S)
        self._said = ""

    def publish(self, step: Step, time: float) -> None:
        """Publish the state where it has changed, and once a second."""
        outlet, estimate = self._outlet, step.estimate
        if outlet is None or estimate is None:
            return
        said = describe_state(estimate)
        if said != self._said or self._cadence.is_due(time):
            self._said = said
            self._cadence.mark(time)
            outlet.write(self._kit.make.diagnosis(time, estimate))


def _can_write(wire: Wire) -> bool:
    """Return whether the other side can read particles; without ROS it takes the type from trundle."""
    if not wire.transport.has_services:
        learn_particle_cloud(wire.types.codec)
    try:
        return wire.types.knows(PARTICLE_CLOUD)
    except InputError:
        return False


class NavigationDiagnosis:
    """Publishes what the navigator does on /diagnostics, where it changes and once a second.

    It is a warning while the robot is blocked, and an error once it has given up.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit
        self._outlet = kit.context.wire.outlet("/diagnostics", DIAGNOSTICS, Qos(10))
        self._cadence = Cadence(STATE_PERIOD_S)
        self._said = ""

    def publish(self, step: Step, time: float) -> None:
        """Publish the status, if it is due."""
        said = step.status.value
        if not self._outlet.is_wanted or (said == self._said and not self._cadence.is_due(time)):
            return
        self._said = said
        self._cadence.mark(time)
        kit, make = self._kit, self._kit.types.make
        status = make(
            "diagnostic_msgs/msg/DiagnosticStatus",
            level=_ERROR if step.status in _GIVEN_UP else _WARN if said == "blocked" else 0,
            name="trundle: navigation",
            message=kit.tasks.refuses or said,
        )
        self._outlet.write(make(DIAGNOSTICS, header=kit.make.header(time, ""), status=[status]))

"""The IMU and the battery of a robot, as its drivers publish them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from trundle.geometry import Twist2D, wrap_angle
from trundle.messages.qos import Qos
from trundle.mission import Step
from trundle.ros2.outputs.motion import EXACT
from trundle.ros2.outputs.output import Cadence
from trundle.ros2.role import BridgeContext

GRAVITY = 9.81
"""What an accelerometer at rest measures upwards [m/s²]."""

BATTERY_PERIOD_S = 1.0


class ImuOutput:
    """Publishes the turn, the turn rate and the acceleration of the robot in every control period.

    They are those of the simulation, without noise, in the frame of the base: the robot stays level. The yaw counts
    from the start of the run.

    Args:
        context: The bridge.
        topic: Its topic.
    """

    def __init__(self, context: BridgeContext, topic: str) -> None:
        wire = context.wire
        self._context, self._types = context, wire.types
        self._outlet = wire.outlet(topic, "sensor_msgs/msg/Imu", Qos(10))
        self._frame = wire.names.frame(context.profile.imu_frame)
        self._covariance = np.diag([EXACT] * 3).ravel()
        self._last: tuple[float, Twist2D] | None = None

    def publish(self, step: Step, time: float) -> None:
        """Publish the end of a control period."""
        twist, last = step.state.twist, self._last
        self._last = time, twist
        if not self._outlet.is_wanted:
            return
        is_next = last is not None and 0.0 < time - last[0] < 1.0
        forward = (twist.v - last[1].v) / (time - last[0]) if last is not None and is_next else 0.0
        yaw = wrap_angle(step.state.pose.yaw - self._context.origin.yaw)
        make = self._types.make
        vector, turn = "geometry_msgs/msg/Vector3", "geometry_msgs/msg/Quaternion"
        self._outlet.write(
            make(
                "sensor_msgs/msg/Imu",
                header=self._context.maker.header(time, self._frame),
                orientation=make(turn, z=math.sin(0.5 * yaw), w=math.cos(0.5 * yaw)),
                orientation_covariance=self._covariance,
                angular_velocity=make(vector, z=twist.w),
                angular_velocity_covariance=self._covariance,
                linear_acceleration=make(vector, x=forward, y=twist.v * twist.w, z=GRAVITY),
                linear_acceleration_covariance=self._covariance,
            )
        )


class BatteryOutput:
    """Publishes a battery of which nothing is known, once a second: none is simulated.

    As sensor_msgs/BatteryState has it, what is not measured is NaN, and the states are unknown.

    Args:
        context: The bridge.
        topic: Its topic.
    """

    def __init__(self, context: BridgeContext, topic: str) -> None:
        wire = context.wire
        self._maker, self._types = context.maker, wire.types
        self._outlet = wire.outlet(topic, "sensor_msgs/msg/BatteryState", Qos(10))
        self._cadence = Cadence(BATTERY_PERIOD_S)

    def publish(self, step: Step, time: float) -> None:
        """Publish it, if it is due."""
        if not self._outlet.is_wanted or not self._cadence.is_due(time):
            return
        self._cadence.mark(time)
        numbers = ("voltage", "temperature", "current", "charge", "capacity", "design_capacity", "percentage")
        unknown: dict[str, Any] = dict.fromkeys(numbers, math.nan)
        header = self._maker.header(time, "")
        self._outlet.write(
            self._types.make(
                "sensor_msgs/msg/BatteryState", header=header, present=True, location="not simulated", **unknown
            )
        )

"""`MppiSettings`: every option of the controller `mppi`, with Nav2's names where the meaning is the same."""

from __future__ import annotations

import math
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from trundle.control.collision import FOOTPRINT_PADDING_M
from trundle.files.yaml_config import Angle, Config, NotNegative, Positive
from trundle.robots import Limits, Robot

MOST_STEPS = 400
_MOST_TURN_RAD = 1.0
"""Most that the robot may turn in one step: the kernel's series for sine and cosine is too coarse beyond it."""

_HORIZON_M, _HORIZON_S = 3.0, (1.6, 2.8)
"""The horizon in metres, within bounds in seconds. A longer one sees more of a detour, but samples spread more."""

_STOPS_WITHIN = 0.85
"""Share of the horizon within which the robot has to be able to stop, so that samples show whether it can."""

_ROOM_SHARE = 0.02  # of the width; with 0.1, 7 of 20 BARN worlds take longer, by 0.7 to 3.9 s
_FULL_SPEED_IN_S, _FULL_TURN_IN_S = 0.6, 0.4
"""Robots with strong motors are driven more gently than they can: no sooner at full speed than after these times."""

Weight = Annotated[float, Field(ge=0.0, le=1e6)]


class MppiSettings(Config):
    """How samples are drawn and what they cost. Costs are in metres of path, so that weights can be compared.

    Attributes:
        samples: How many sequences of commands are tried in each control period; rounded up to a multiple of 16.
        horizon: How far ahead they look [s]. If None, as long as 3 m take at top speed, from 1.6 to 2.8 s. Where the
            robot takes longer to stop than 0.85 of it, longer steps make it longer.
        model_dt: Length of their steps [s].
        vx_std: Deviation of the samples' speed [m/s]. If None, a quarter of the robot's top speed, and 0.3 of it near
            anything that moves.
        wz_std: Deviation of their turning speed [rad/s]. If None, 0.3 of the robot's, and 0.375 near anything that
            moves.
        knot_steps: Noise changes every so many steps, and evenly in between; at most every third of the horizon.
        vx_max: Highest speed [m/s]. If None, the robot's limit.
        vx_min: Highest speed backwards, as a negative number [m/s]; 0 forbids driving backwards. If None, the robot's
            limit. Outside of stretches that the planner drives backwards it costs `prefer_forward_weight`.
        wz_max: Highest turning speed [rad/s]. If None, the robot's limit.
        ax_max: Acceleration and deceleration of the samples [m/s²]. If None, the robot's limit, or what reaches its top
            speed in 0.6 s if that is less.
        az_max: Angular acceleration of the samples [rad/s²]. If None, the robot's limit, or what reaches its top
            turning speed in 0.4 s if that is less.
        best_share: How many samples the answer is the average of, as a share; at most half of those that touch nothing.
        to_go_weight: Weight of the cost to go, its mean along the sample.
        goal_weight: Weight of the cost to go at its end (GoalCritic, PathFollowCritic).
        path_angle_weight: Weight of the angle to where the cost to go falls (PathAngleCritic).
        max_angle_to_path: Angle up to which that costs nothing [rad].
        goal_angle_weight: Weight of the angle to the goal's yaw, near the goal (GoalAngleCritic).
        threshold_to_consider: How near the goal its yaw begins to count [m].
        overshoot_weight: Weight of ending too fast to stop at the end of the path, per metre past it.
        collision_cost: Cost of touching an obstacle (ObstaclesCritic).
        repulsion_weight: Weight of being near one, per metre driven (ObstaclesCritic).
        inflation_radius: How near that is [m], from the discs' edge.
        slow_near_weight: Weight of driving fast there, per metre and m/s.
        mover_weight: Weight of being near something that moves, per second.
        mover_contact_cost: Cost of touching it, where it surely is then; half of that at the end of the horizon.
        mover_margin: Distance to keep from it [m].
        mover_sigmas: How many standard deviations of its predicted place are added to that.
        prefer_forward_weight: Weight of driving against the planned direction, per metre (PreferForwardCritic).
        twirling_weight: Weight of turning, per radian (TwirlingCritic).
        constraint_weight: Weight of driving faster than a speed limit (ConstraintCritic).
        acceleration_weight: Weight of accelerations, the mean of their squares as shares of the robot's limits.
        jerk_weight: Weight of their changes from step to step, likewise.
        near_path_weight: How much longer a metre counts right beside an obstacle in the cost to go, as a share.
        near_path_distance: How fast that falls with the distance from it [m].
        footprint_padding: What the discs and the outline are widened by [m].
        sampling_room: Clearance [m] that the footprint needs along the next part of the path for samples to be drawn;
            where it has less, the robot follows the path itself until it has twice as much. If None, a fiftieth of the
            footprint's width; if 0, samples are drawn wherever they fit.
        goal_tolerance: How near the path's end counts as there [m].
        goal_yaw_tolerance: How near its yaw [rad].

    Raises:
        InputError: If a value is out of range.
    """

    samples: Annotated[int, Field(ge=128, le=65_536)] = 2000
    horizon: Annotated[float, Field(ge=0.2, le=20.0)] | None = None
    model_dt: Annotated[float, Field(ge=0.005, le=0.5)] = 0.05
    vx_std: Positive | None = None
    wz_std: Positive | None = None
    knot_steps: Annotated[int, Field(ge=1, le=64)] = 7
    vx_max: Positive | None = None
    vx_min: Annotated[float, Field(le=0.0)] | None = None
    wz_max: Positive | None = None
    ax_max: Positive | None = None
    az_max: Positive | None = None
    best_share: Annotated[float, Field(gt=0.0, le=1.0)] = 0.1
    to_go_weight: Weight = 3.0
    goal_weight: Weight = 1.0
    path_angle_weight: Weight = 1.0
    max_angle_to_path: Annotated[Angle, Field(ge=0.0)] = 0.3
    goal_angle_weight: Weight = 1.0
    threshold_to_consider: Positive = 0.5
    overshoot_weight: Weight = 5.0
    collision_cost: Weight = 100.0
    repulsion_weight: Weight = 4.0
    inflation_radius: NotNegative = 0.2
    slow_near_weight: Weight = 0.0
    mover_weight: Weight = 20.0
    mover_contact_cost: Weight = 200.0
    mover_margin: NotNegative = 0.5
    mover_sigmas: NotNegative = 1.0
    prefer_forward_weight: Weight = 2.0
    twirling_weight: Weight = 0.02
    constraint_weight: Weight = 10.0
    acceleration_weight: Weight = 0.1
    jerk_weight: Weight = 0.2
    near_path_weight: Weight = 2.0
    near_path_distance: Positive = 0.3
    footprint_padding: NotNegative = FOOTPRINT_PADDING_M
    sampling_room: NotNegative | None = None
    goal_tolerance: Positive = 0.05
    goal_yaw_tolerance: Annotated[Angle, Field(gt=0.0)] = 0.05

    def limits_of(self, robot: Robot) -> Limits:
        """Return the limits of the samples: the robot's, or those of the settings where they are less."""
        own = robot.limits
        forward = min(own.linear_speed, self.vx_max or math.inf)
        back = own.linear_speed if own.reverse_speed is None else own.reverse_speed
        turn = min(own.angular_speed, self.wz_max or math.inf, _MOST_TURN_RAD / self.model_dt)
        return Limits(
            linear_speed=forward,
            reverse_speed=back if self.vx_min is None else min(back, -self.vx_min),
            angular_speed=turn,
            linear_acceleration=min(own.linear_acceleration, self.ax_max or own.linear_speed / _FULL_SPEED_IN_S),
            angular_acceleration=min(own.angular_acceleration, self.az_max or own.angular_speed / _FULL_TURN_IN_S),
        )

    def room_of(self, robot: Robot) -> float:
        """Return the clearance of a robot's footprint [m] with less of which it follows the path itself."""
        if self.sampling_room is not None:
            return self.sampling_room
        return _ROOM_SHARE * float(np.ptp(robot.outline[:, 1]))

    def step_s(self, robot: Robot) -> float:
        """Return the length of a step [s], long enough for the robot to stop within all of them."""
        limits = self.limits_of(robot)
        fastest = max(limits.linear_speed, limits.reverse_speed or 0.0)
        stop_s = max(fastest / limits.linear_acceleration, limits.angular_speed / limits.angular_acceleration)
        return max(self.model_dt, stop_s / (_STOPS_WITHIN * self.steps_of(robot)))

    def steps_of(self, robot: Robot) -> int:
        """Steps of a sample of a robot."""
        horizon = self.horizon
        if horizon is None:
            fastest = self.limits_of(robot).linear_speed
            horizon = min(_HORIZON_S[1], max(_HORIZON_S[0], _HORIZON_M / fastest))
        return max(2, round(horizon / self.model_dt))

    @model_validator(mode="after")
    def _check(self) -> Self:
        horizon = _HORIZON_S[1] if self.horizon is None else self.horizon
        steps = round(horizon / self.model_dt)
        if not 2 <= steps <= MOST_STEPS:
            raise ValueError(
                f"horizon {horizon:g} s in steps of {self.model_dt:g} s makes {steps} steps, it must be 2 to "
                f"{MOST_STEPS}: use another model_dt"
            )
        return self

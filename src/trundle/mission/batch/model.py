"""`numbers_of`: what the kernel of missions takes of a navigator, as arrays."""

from __future__ import annotations

import math

import numpy as np

from trundle.control.pursuit_settings import PursuitSettings
from trundle.control.regulated_pure_pursuit import RegulatedPurePursuit
from trundle.geometry import FloatArray
from trundle.navigation import Navigator
from trundle.sim.kinematic import TIMESTEP
from trundle.sim.ramp import count_steps


def numbers_of(navigator: Navigator) -> tuple[FloatArray, ...]:
    """What the kernel takes of a costmap's inflation, the robot, and the settings of a navigator.

    Raises:
        InputError: If the control period is no multiple of the simulator's substep.
    """
    costmap, robot, controller = navigator.costmap, navigator.robot, navigator.controller
    # Others decide on their own; the kernel then moves and judges alone.
    settings = controller.settings if isinstance(controller, RegulatedPurePursuit) else PursuitSettings()
    limits, drive = robot.limits, robot.drive
    goal, progress = navigator.goal_checker, navigator.progress_checker
    return (
        np.array([costmap.inscribed_radius, costmap.cost_scaling_factor, costmap.inflation_radius]),
        np.ascontiguousarray(robot.planar.outline),
        np.ascontiguousarray(robot.planar.padded(settings.footprint_padding).outline),
        np.array(
            [
                limits.linear_speed,
                limits.linear_speed if limits.reverse_speed is None else limits.reverse_speed,
                limits.angular_speed,
                limits.linear_acceleration,
                limits.angular_acceleration,
                drive.wheel_radius,
                drive.track_width,
                math.inf if drive.max_wheel_speed is None else drive.max_wheel_speed,
                TIMESTEP,
                count_steps(navigator.dt, TIMESTEP),
                navigator.dt,
            ]
        ),
        np.array(
            [
                math.inf if settings.desired_linear_vel is None else settings.desired_linear_vel,
                settings.lookahead_dist,
                settings.min_lookahead_dist,
                settings.rotate_to_heading_min_angle,
                settings.rotate_to_heading_angular_vel,
                settings.regulated_linear_scaling_min_radius,
                settings.regulated_linear_scaling_min_speed,
                settings.cost_scaling_dist,
                settings.approach_velocity_scaling_dist,
                settings.min_approach_linear_velocity,
                settings.approach_deceleration,
                settings.acceleration_of(robot),
                settings.footprint_padding,
            ]
        ),
        np.array([goal.xy_tolerance, goal.yaw_tolerance, goal.stopped_linear, goal.stopped_angular]),
        np.array(
            [
                progress.required_movement_radius,
                progress.required_movement_angle,
                progress.movement_time_allowance,
            ]
        ),
    )

"""`NavigatorSettings`: when a navigator has arrived, is stuck, and plans again."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from trundle.control import GoalChecker, ProgressChecker
from trundle.files.yaml_config import Angle, Config, NotNegative, Positive
from trundle.navigation.behaviors.behavior import BehaviorChoice, BehaviorChoices
from trundle.navigation.progress import RETRIES

LEAST_FREQUENCY, MOST_FREQUENCY = 0.1, 1000.0
"""The lowest and the highest frequency of control [Hz]."""


class NavigatorSettings(Config):
    """When the goal is reached, when the robot is stuck, and when it plans again.

    A scenario has these fields at its top level, and `trundle run` has an option for each.

    Attributes:
        goal_tolerance: The goal is reached within this distance [m] (Nav2's `xy_goal_tolerance`).
        goal_yaw_tolerance: The goal is reached within this angle of its yaw [rad] (Nav2's `yaw_goal_tolerance`).
        through_tolerance: A goal that the robot drives through is passed within this distance [m].
        required_movement_radius: The robot makes progress when it moves this far [m].
        movement_time_allowance: Without progress for longer than this [s] the robot is stuck.
        control_frequency: Commands per second [Hz], 0.1 to 1000.
        replan_interval_s: After this time [s] it looks for a better path. If None, only where the path is blocked.
        replan_margin: A path that is not blocked is replaced by one that is cheaper by this share of what is left of
            it, so that the robot does not oscillate between equal-cost paths.
        planning_deadline_s: How long a plan may take [s] of the computer's time. After that the robot waits for 1 s and
            tries again, three times at most, and each try may take twice as long as the one before. While the robot
            moves, a plan may take a quarter of it; where that is not enough, or the last plan took longer, the robot is
            stopped first. None means as long as it takes: the run does not depend on how busy the computer is.
        replan_rate: Limit on planning again [1/s]: each second of a drive allows so many expansions. After a plan that
            took many, the next one waits. Unlike a deadline, it gives the same run on a busy computer. None
            means no limit.
        replan_expansions: Limit on the expansions of all plans but the first in a drive of up to ten minutes; a longer
            drive may take proportionally more. Beyond it, only short searches are made while what was sensed blocks the
            path, and otherwise the run ends without a path. None means no limit.
        wait_s: How long the robot waits [s] for an obstacle on its path, seen by its lidars, to move away, where the
            path round it is longer by more than 3 m.
        patience_s: How long the robot waits [s] before it gives up, where an obstacle that is not on the map leaves no
            path, or occupies the goal.
        mover_patience_s: The same [s] for an obstacle that was seen to move, and so may leave; the longer of the two
            applies. After 10 s, where `back_up` is a step of recovery, the robot drives to where others can pass, waits
            there and plans again; that starts the time over, up to six times on the way to a goal.
        recovery: The steps that a robot takes, in this order, when it makes no progress: `replan`, `back_up`,
            `drive_clear`, `spin`, `wait`, `drive_on_heading`, `clear_costmap`, `replan_with` or one of a plug-in; with
            a value (`back_up=0.5`) or options (`{back_up: {distance: 0.5}}`). Each time that the robot is blocked, the
            next step runs. If a step fails, the one after it runs at once. `drive_clear` runs only where the robot
            touches something, or nearly does. Without any step, the robot gives up.
        recovery_retries: How many steps it takes in a row before it gives up (Nav2's `number_of_retries`). The count
            restarts when 0.5 m less of the path is left.

    Raises:
        InputError: If a value is out of range.
    """

    goal_tolerance: NotNegative = 0.25
    goal_yaw_tolerance: Annotated[Angle, Field(ge=0.0)] = 0.25
    through_tolerance: Positive = 0.5
    required_movement_radius: NotNegative = 0.5
    movement_time_allowance: NotNegative = 10.0
    control_frequency: Annotated[float, Field(ge=LEAST_FREQUENCY, le=MOST_FREQUENCY)] = 20.0
    replan_interval_s: Positive | None = None
    replan_margin: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.1
    planning_deadline_s: Positive | None = 2.0
    # Hybrid A* expands 50,000 to 90,000 nodes a second. In benchmarks/sensing/closed_offices.yaml a plan that finds no
    # path takes 400,000 to 920,000, and a drive without limits took 7,500,000 (seed 2). Of the 18 of 138 drives that
    # arrived none planned longer than the one that took 1,026,000, and with 3,000,000 one of 243 took 122 s of wall
    # time; of 7 missions of boxes.yaml and movers.yaml, which all arrived, none took over 45,000.
    replan_rate: Positive | None = 100_000
    replan_expansions: Annotated[int, Field(ge=1)] | None = 1_200_000
    wait_s: NotNegative = 2.0
    patience_s: NotNegative = 20.0
    mover_patience_s: NotNegative = 60.0
    recovery: BehaviorChoices = (
        BehaviorChoice(name="replan"),
        BehaviorChoice(name="back_up"),
        BehaviorChoice(name="drive_clear"),
    )
    recovery_retries: Annotated[int, Field(ge=0, le=1000)] = RETRIES

    def make_goal_checker(self) -> GoalChecker:
        """Make what says whether the goal is reached."""
        return GoalChecker(self.goal_tolerance, self.goal_yaw_tolerance)

    def make_progress_checker(self) -> ProgressChecker:
        """Make what says whether the robot makes progress."""
        return ProgressChecker(self.required_movement_radius, movement_time_allowance=self.movement_time_allowance)

"""`Helm`: applies directives to a run, between its control periods."""

from __future__ import annotations

import time as clock
from collections import deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, cast

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.fault import Fault, find_fault, is_of_plugin
from trundle.geometry import Pose2D, Twist2D
from trundle.mission.episode import Outcome
from trundle.mission.running.course import Course
from trundle.mission.running.endings import Ending
from trundle.mission.steering import directives as kinds
from trundle.mission.steering.directives import GivenDirective
from trundle.mission.steering.queue import DEAD_MAN_S, Order, Steering
from trundle.mission.steering.report import SteeringReport
from trundle.mission.steering.tasks import RunningTasks
from trundle.mission.truth import DroppedBox
from trundle.navigation import Agent
from trundle.navigation.command_check import AssistedCommand
from trundle.observation import Estimate, Observation
from trundle.robots import Robot
from trundle.sim import RobotState, Simulator, add_solid, world_of
from trundle.sim.footprint import FootprintChecker
from trundle.worlds import World

if TYPE_CHECKING:
    from trundle.mission.observers import MonitorReport

_STAND = Twist2D()

MOST_KEPT = 10_000
"""How many directives are kept of a run without an end."""


class Helm:
    """Applies directives to a run, and keeps what they have set; only the thread that drives the run uses it.

    Args:
        course: The goals of the run.
        sim: Its simulator.
        robot: Its robot.
        steering: Where directives come from while it drives; None without any.
        recorded: The directives of an earlier run, which are given again at the same moments.
        relocate: Tells the localizer where the robot is, and returns what it believes then.
        place: Puts the robot somewhere else, and returns its state there, and what it believes then.

    Attributes:
        run: Number of the run among those of its steering.
        paused: Whether the run is paused.
        manual: The command by hand; None where the agent drives.
        speed: How fast the run is to pass, relative to real time.
        log: All directives that were given so far.
        ending: How the run was ended by a directive, or None.
        boxes: What was dropped into the world so far.
        restart: What asked for another run after this one, or None.
        held_back: What kept the last command by hand from being sent as it was; empty where nothing did.
    """

    def __init__(
        self,
        course: Course,
        sim: Simulator,
        robot: Robot,
        steering: Steering | None,
        recorded: Sequence[GivenDirective],
        relocate: Callable[[Pose2D], Estimate],
        place: Callable[[Pose2D], tuple[RobotState, Estimate]],
    ) -> None:
        self._tasks = RunningTasks(course)
        self._relocate, self._place = relocate, place
        self._course, self._sim, self._robot, self._steering = course, sim, robot, steering
        self._recorded = deque(recorded)
        self._steps_left = 0
        self._by = ""
        self._holds_until: float | None = None
        self.boxes: list[DroppedBox] = []
        self.run = 1
        self.paused = False
        self.manual: Twist2D | None = None
        self.speed = 1.0
        self.log: deque[GivenDirective] = deque()
        self.ending: Ending | None = None
        self.restart: kinds.Restart | None = None
        self.held_back = ""

    def begin(self) -> None:
        """The run begins: it takes the orders that are given from now on."""
        self.run = 1 if self._steering is None else self._steering.begin()

    def keep_last(self) -> None:
        """Keep only the last directives in the log."""
        self.log = deque(self.log, maxlen=MOST_KEPT)

    @property
    def is_held(self) -> bool:
        """Whether no control period may be driven now."""
        return self.paused and self._steps_left == 0

    @property
    def report(self) -> SteeringReport:
        """How the run is steered now."""
        by, goals = "" if self.manual is None else self._by, self._course.goals
        return SteeringReport(self.paused, self.manual, self.held_back, by, self.speed, goals, len(self.boxes))

    def steer(self, index: int, state: RobotState, estimate: Estimate) -> None:
        """Apply what is due after so many control periods, in this state."""
        self._state, self._estimate = state, estimate
        while self.ending is None and self._recorded and self._recorded[0].index <= index:
            given = self._recorded.popleft()
            self._give(Order(given.directive, given.by), index)
        if self._steering is None:
            return
        for _ in range(self._steering.waiting):
            order = self._steering.take(self.run) if self.ending is None else None
            if order is None:
                return
            self._give(order, index)
        if self._holds_until is not None and clock.monotonic() > self._holds_until:
            self._give(Order(kinds.Manual(), "dead-man"), index)

    def wait(self) -> None:
        """Wait for the next directive of a run that is paused; without any to come, the run ends."""
        if self._steering is not None:
            self._steering.wait()
        elif self.ending is None:
            self.ending = Outcome.ABORTED, "the run is paused, and its record has no more directives"

    def assist(self, agent: Agent, observation: Observation, estimate: Estimate) -> Twist2D:
        """What of the command by hand passes the agent's stop check, if it has one."""
        wish = self._robot.limits.clamp(self.manual or _STAND)
        check = getattr(agent, "assist_teleop", None)
        if not callable(check):
            return wish
        passed = cast("AssistedCommand", check(wish, observation, estimate))
        self.held_back = passed.reason
        return passed.command

    def stop(self, why: str, time: float, fault: Fault | None = None) -> None:
        """The run has ended at this time [s], by an exception where there is a fault; orders that wait are refused."""
        try:
            self._tasks.stop(why, time, fault)
        finally:
            if self._steering is not None:
                self._steering.end(self.run, "the run has ended")

    def finish_period(self, command: Twist2D, report: MonitorReport | None, time: float) -> SteeringReport:
        """Count a control period that ends at a time [s], with what a monitor did to its command; report it."""
        self._tasks.check(time)
        self._steps_left = max(0, self._steps_left - 1)
        if self.manual is None:
            self.held_back = ""
        elif report is not None and report.command != command:
            self.held_back = f"the collision monitor: {report.action}"
        return self.report

    # Directives -----------------------------------------------------------------------------------------------------

    def _give(self, order: Order, index: int) -> None:
        if self._is_renewal(order):
            return
        refused: TrundleError | None = None
        broken: BaseException | None = None
        try:
            self._apply(order, index, self._state)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # noqa: BLE001 - it is raised once who waits for the directive has been told
            if isinstance(error, TrundleError) and not is_of_plugin(error):
                refused = error
            else:
                broken, refused = error, TrundleError(str(find_fault(error)))
        self.log.append(GivenDirective(index, self._state.time, order.directive, order.by, str(refused or "")))
        if refused is not None:
            order.refuse(refused)
        elif order.applied is not None:
            order.applied()
        if broken is not None:
            raise broken

    def _is_renewal(self, order: Order) -> bool:
        """Whether this repeats the command by hand that holds, which is then held for longer."""
        command = order.directive
        if not isinstance(command, kinds.Manual) or self.manual != Twist2D(command.v, command.w):
            return False
        self._hold(order)
        return self._by == order.by

    def _hold(self, order: Order) -> None:
        moves = self.manual is not None and self.manual != _STAND
        self._holds_until = order.given_s + DEAD_MAN_S if moves and order.given_s is not None else None

    def _apply(self, order: Order, index: int, state: RobotState) -> None:
        match order.directive:
            case kinds.Pause(paused):
                self._pause(paused)
            case kinds.StepOnce(periods):
                self.paused = True
                self._steps_left += periods
            case kinds.Speed(factor):
                self.speed = factor
            case kinds.SetGoal(append=append) as given:
                self._course.set_goal(given.target, state, self._estimate, append=append)
                self._begin_goal(order, state)
            case kinds.SetGoals(through=through) as given:
                self._course.set_goals(given.targets, state, self._estimate, through=through)
                self._begin_goal(order, state)
            case kinds.FollowPath() as given:
                self._course.follow(given.path, state, self._estimate)
                self._begin_goal(order, state)
            case kinds.RunBehavior() as given:
                self._course.need_navigator("runs no behaviors").run(given.make())
                self._let_go()
                self._tasks.begin_behavior(order.watcher, state.time)
            case kinds.Cancel(what):
                self._course.cancel(behavior_alone=what == "behavior")
                self._let_go()
                self._tasks.cancel(state.time, behavior_alone=what == "behavior")
            case kinds.ClearObstacles(region, size):
                self._course.need_navigator("has no costmap to clear").clear_obstacles(region, size)
            case kinds.SetPose() as given:
                self._estimate = self._relocate(given.target)
            case kinds.Manual(v, w):
                self.manual, self._by = Twist2D(v, w), order.by
                self._hold(order)
            case kinds.Release():
                if self.manual is not None:
                    self._let_go()
                    self._course.set_again()
            case kinds.DropBox() as box:
                self._drop(box, index, state)
            case kinds.PlaceRobot() as place:
                self._put_robot(place.pose)
            case kinds.Restart() as restart:
                self.restart, self.ending = restart, (Outcome.ABORTED, "ended to start again")
            case kinds.End(why):
                self.ending = self._course.ended_by_hand(why)

    def _begin_goal(self, order: Order, state: RobotState) -> None:
        self._let_go()
        self._tasks.begin_goal(order.watcher, state.time)

    def _pause(self, paused: bool) -> None:
        resumes, self.paused, self._steps_left = self.paused and not paused, paused, 0
        if resumes and self.manual is None:
            self._course.set_again()

    def _let_go(self) -> None:
        self.manual, self._holds_until, self._by = None, None, ""

    def _drop(self, box: kinds.DropBox, index: int, state: RobotState) -> None:
        solid = box.solid(self._free_name())
        checker = FootprintChecker(World("box", (solid,)), self._robot)
        if checker.find(np.array([state.pose.as_tuple()])):
            raise InputError(f"a box at ({box.x:.2f}, {box.y:.2f}) would overlap the robot; drop it beside the robot")
        add_solid(self._sim, solid)
        self.boxes.append(DroppedBox(index, solid))

    def _put_robot(self, pose: Pose2D) -> None:
        world = world_of(self._sim)
        touched = [] if world is None else FootprintChecker(world, self._robot).find(np.array([pose.as_tuple()]))
        if touched:
            raise InputError(
                f"at ({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f}) the robot would touch {touched[0].other}"
            )
        self._state, self._estimate = self._place(pose)
        if self.manual is None:
            self._course.set_again()

    def _free_name(self) -> str:
        """A name that no solid of the world has."""
        world = world_of(self._sim)
        taken = set() if world is None else {solid.name for solid in world.solids}
        number = len(self.boxes) + 1
        while f"dropped_box_{number}" in taken:
            number += 1
        return f"dropped_box_{number}"

"""`DirectiveExecutor`: applies directives to a run, between its control periods."""

from __future__ import annotations

import time as clock
from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.fault import Fault, find_fault, is_of_plugin
from trundle.geometry import Pose2D, Twist2D
from trundle.mission.episode import Outcome
from trundle.mission.metrics import DroppedBox
from trundle.mission.observers import SteeringReport
from trundle.mission.running.endings import Ending
from trundle.mission.running.goal_sequence import GoalSequence
from trundle.mission.running.robot_stack import RobotStack
from trundle.mission.steering import directives as kinds
from trundle.mission.steering.directives import GivenDirective
from trundle.mission.steering.queue import DEAD_MAN_S, Order, Steering, TaskEnd, TaskResult, TaskWatcher
from trundle.navigation import NavigationStatus
from trundle.navigation.behaviors.behavior import ASKED_FOR
from trundle.navigation.state import FINAL
from trundle.sim import RobotState, Simulator
from trundle.sim.footprint import FootprintChecker
from trundle.worlds import World

_STAND = Twist2D()

MOST_KEPT = 10_000
"""How many directives are kept of a run without an end."""


class DirectiveExecutor:
    """Applies directives to a run, and keeps what they have set; only the thread that drives the run uses it.

    Args:
        goals: The goals of the run.
        stack: The robot's software.
        sim: Its simulator.
        steering: Where directives come from while it drives; None without any.
        recorded: The directives of an earlier run, which are given again at the same moments.
        place: Puts the robot somewhere else, and returns its state there.

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
        goals: GoalSequence,
        stack: RobotStack,
        sim: Simulator,
        steering: Steering | None,
        recorded: Sequence[GivenDirective],
        place: Callable[[Pose2D], RobotState],
    ) -> None:
        self._tasks = RunningTasks(goals, stack)
        self._place = place
        self._goals, self._stack, self._sim, self._steering = goals, stack, sim, steering
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
        return self._steps_left == 0 and (self.paused or self.is_waiting)

    @property
    def is_waiting(self) -> bool:
        """Whether the run goes on after its goals, and waits for another one, or for a command by hand."""
        if self._steering is None or self._recorded or self.manual is not None:
            return False
        return self._goals.goes_on and self._goals.rests(self._state)

    @property
    def report(self) -> SteeringReport:
        """How the run is steered now."""
        by, goals = "" if self.manual is None else self._by, self._goals.goals
        return SteeringReport(self.paused, self.manual, self.held_back, by, self.speed, goals, len(self.boxes))

    def steer(self, index: int, state: RobotState) -> None:
        """Apply what is due after so many control periods, in this state."""
        self._state = state
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

    def assist(self) -> Twist2D:
        """Return what of the command by hand passes the agent's stop check."""
        assisted = self._stack.assist(self._stack.robot.limits.clamp(self.manual or _STAND))
        self.held_back = assisted.reason
        return assisted.command

    def stop(self, why: str, time: float, fault: Fault | None = None) -> None:
        """End the orders at this time [s], by an exception where there is a fault; refuse those that wait."""
        try:
            self._tasks.stop(why, time, fault)
        finally:
            if self._steering is not None:
                self._steering.end(self.run, "the run has ended")

    def finish_period(self, command: Twist2D, time: float) -> SteeringReport:
        """Count a control period of this command that ends at a time [s]; report it."""
        report = self._stack.monitored
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
        """Return whether this repeats the command by hand that holds, which is then held for longer."""
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
                self._goals.set_goal(given.target, state, append=append)
                self._begin_goal(order, state)
            case kinds.SetGoals(through=through) as given:
                self._goals.set_goals(given.targets, state, through=through)
                self._begin_goal(order, state)
            case kinds.FollowPath() as given:
                self._goals.follow(given.path, state)
                self._begin_goal(order, state)
            case kinds.RunBehavior() as given:
                self._stack.agent.run(given.make())
                self._stack.ask_report()
                self._let_go()
                self._tasks.begin_behavior(order.watcher, state.time)
            case kinds.Cancel(what):
                if what == "behavior":
                    self._stack.agent.cancel_behavior()
                    self._stack.ask_report()
                else:
                    self._goals.cancel()
                self._let_go()
                self._tasks.cancel(state.time, behavior_alone=what == "behavior")
            case kinds.ClearObstacles(region, size, at):
                elsewhere = {} if at is None else {"at": Pose2D.of(at)}
                self._stack.agent.clear_obstacles(region, size, **elsewhere)
            case kinds.SetPose() as given:
                self._stack.relocate(given.target, given.covariance)
            case kinds.ReinitializeGlobal():
                self._stack.reinitialize_global()
            case kinds.Manual(v, w):
                self.manual, self._by = Twist2D(v, w), order.by
                self._hold(order)
            case kinds.Release():
                if self.manual is not None:
                    self._let_go()
                    self._goals.set_again()
            case kinds.DropBox() as box:
                self._drop(box, index, state)
            case kinds.PlaceRobot() as place:
                self._put_robot(place.pose)
            case kinds.WaitAtGoal():
                self._goals.goes_on = True
            case kinds.Restart() as restart:
                why = "ended to start again"
                self.restart = restart
                self.ending = self._goals.arrived_before(why, state) or (Outcome.ABORTED, why)
            case kinds.End(why):
                self.ending = self._goals.arrived_before(why, state) or self._goals.ended_by_hand(why)

    def _begin_goal(self, order: Order, state: RobotState) -> None:
        self._let_go()
        self._tasks.begin_goal(order.watcher, state.time)

    def _pause(self, paused: bool) -> None:
        resumes, self.paused, self._steps_left = self.paused and not paused, paused, 0
        if resumes and self.manual is None:
            self._goals.set_again()

    def _let_go(self) -> None:
        self.manual, self._holds_until, self._by = None, None, ""

    def _drop(self, box: kinds.DropBox, index: int, state: RobotState) -> None:
        solid = box.solid(self._free_name())
        checker = FootprintChecker(World("box", (solid,)), self._stack.robot)
        if checker.find(np.array([state.pose.as_tuple()])):
            raise InputError(f"a box at ({box.x:.2f}, {box.y:.2f}) would overlap the robot; drop it beside the robot")
        self._sim.add_solid(solid)
        self.boxes.append(DroppedBox(index, solid))

    def _put_robot(self, pose: Pose2D) -> None:
        world = self._sim.world
        touched = [] if world is None else FootprintChecker(world, self._stack.robot).find(np.array([pose.as_tuple()]))
        if touched:
            raise InputError(
                f"at ({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f}) the robot would touch {touched[0].other}"
            )
        self._state = self._place(pose)
        if self.manual is None:
            self._goals.set_again()

    def _free_name(self) -> str:
        """Return a name that no solid of the world has."""
        world = self._sim.world
        taken = set() if world is None else {solid.name for solid in world.solids}
        number = len(self.boxes) + 1
        while f"dropped_box_{number}" in taken:
            number += 1
        return f"dropped_box_{number}"


class RunningTasks:
    """The tasks of a run that somebody watches: its goals, and the behavior that was asked for.

    Args:
        goals: The goals of the run.
        stack: The robot's software.
    """

    def __init__(self, goals: GoalSequence, stack: RobotStack) -> None:
        self._goals, self._stack = goals, stack
        self._goal: TaskWatcher | None = None
        self._behavior: TaskWatcher | None = None

    def begin_goal(self, watcher: TaskWatcher | None, time: float) -> None:
        """The run has another goal; what was running is replaced."""
        self._end_both("replaced", "there is another goal", time)
        self._goal = watcher
        if watcher is not None:
            watcher.begin(time)

    def begin_behavior(self, watcher: TaskWatcher | None, time: float) -> None:
        """The run was asked for a behavior; another one that ran is replaced."""
        self._end_behavior("replaced", "another behavior was asked for", time)
        self._behavior = watcher
        if watcher is not None:
            watcher.begin(time)

    def cancel(self, time: float, *, behavior_alone: bool) -> None:
        """What runs was cancelled."""
        self._end_behavior("cancelled", "cancelled", time)
        if not behavior_alone:
            self._end_goal("cancelled", "cancelled", time)

    def stop(self, why: str, time: float, fault: Fault | None) -> None:
        """The run has ended, by an exception where there is a fault."""
        self._end_both("stopped" if fault is None else "failed", why, time, fault)

    def check(self, time: float) -> None:
        """Conclude the orders that have ended in the last control period, by what the agent reports."""
        report = self._stack.report
        if self._behavior is not None and report.status is not NavigationStatus.BEHAVING:
            ran = next((run for run in reversed(report.behaviors) if run.reason == ASKED_FOR), None)
            if ran is not None and ran.result != "running":
                self._end_behavior("succeeded" if ran.result == "succeeded" else "failed", ran.message, time)
        if self._goal is None:
            return
        if self._goals.is_done and report.status is NavigationStatus.ARRIVED:
            self._end_goal("succeeded", "", time)
        elif report.status in FINAL and report.status is not NavigationStatus.ARRIVED:
            error = report.error
            self._end_goal("failed", report.message or str(error or report.status.value), time, error)

    def _end_both(self, result: TaskResult, message: str, time: float, fault: Fault | None = None) -> None:
        self._end_behavior(result, message, time, fault)
        self._end_goal(result, message, time, fault=fault)

    def _end_goal(
        self,
        result: TaskResult,
        message: str,
        time: float,
        error: TrundleError | None = None,
        fault: Fault | None = None,
    ) -> None:
        watcher, self._goal = self._goal, None
        if watcher is not None:
            watcher.end(TaskEnd(result, message, time, self._stack.report.status, error, fault))

    def _end_behavior(self, result: TaskResult, message: str, time: float, fault: Fault | None = None) -> None:
        watcher, self._behavior = self._behavior, None
        if watcher is not None:
            watcher.end(TaskEnd(result, message, time, self._stack.report.status, fault=fault))

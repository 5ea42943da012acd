"""`ControlLoop`: one control period of a run after the other."""

from __future__ import annotations

import time as clock
from dataclasses import replace

from trundle.fault import Fault
from trundle.geometry import Pose2D, Twist2D
from trundle.mission.observers import Observers, RunInfo, Step
from trundle.mission.running.endings import Ending
from trundle.mission.running.goal_sequence import GoalSequence
from trundle.mission.running.robot_stack import RobotStack
from trundle.mission.steering.directive_executor import DirectiveExecutor
from trundle.sim import RobotState, Simulator


class ControlLoop:
    """Steps a world with the software of its robot, and tells the observers.

    Args:
        sim: What moves the robot.
        backend: The same without what delays commands, for directives that change the world.
        stack: The robot's software.
        goals: The goals of the run.
        observers: Notified of each period.

    Attributes:
        state: State of the simulator now: the truth.
        executor: What applies directives; None in a run that takes none.
        returns_steps: Whether somebody besides the observers wants `last`.
        last: What the observers got last.
        began_s: When the first control period began [s], by `time.perf_counter`.
    """

    def __init__(
        self, sim: Simulator, backend: Simulator, stack: RobotStack, goals: GoalSequence, observers: Observers
    ) -> None:
        self._sim, self._backend = sim, backend
        self.stack, self.goals, self._observers = stack, goals, observers
        self.executor: DirectiveExecutor | None = None
        self.state: RobotState
        self.returns_steps = True
        self.last: Step | None = None
        self.began_s = clock.perf_counter()
        self._watches = False

    @property
    def dt(self) -> float:
        """Length of the next control period [s]."""
        return self.stack.agent.dt

    def begin(self, info: RunInfo) -> None:
        """Put the robot at its start, and tell the observers."""
        stack = self.stack
        self._watches = self._observers.want_substeps and self._backend.watch_substeps(self._observers.on_substep)
        stack.reset(info.start, seed=info.seed)
        self.state = self._sim.reset(info.start, seed=info.seed)
        self.began_s = clock.perf_counter()
        stack.observe(self.state)
        stack.ask_report()
        stack.planning_s = stack.report.planning_time_s
        if self.executor is not None:
            self.executor.begin()
        self._observers.on_start(info)
        self._record(Twist2D(), Twist2D())

    def steer(self) -> Ending | None:
        """Apply the directives that are due; or how one of them ends the run."""
        if self.executor is None:
            return None
        self.executor.steer(len(self.stack.log) - 1, self.state)
        return self.executor.ending

    @property
    def is_held(self) -> bool:
        """Whether the run is paused, and no control period may be driven now."""
        return self.executor is not None and self.executor.is_held

    def steer_and_drive(self) -> Ending | None:
        """Apply the directives that are due, and wait while the run is paused; then drive one control period."""
        while (ending := self.steer()) is None and self.executor is not None and self.executor.is_held:
            self.executor.wait()
        return self.drive() if ending is None else ending

    def drive(self) -> Ending | None:
        """Drive one control period; or how the run ends instead.

        What the robot observes and believes at its beginning is known from the end of the one before.
        """
        stack, by_hand = self.stack, self.executor is not None and self.executor.manual is not None
        stack.wants_rollouts = self.returns_steps or self._observers.want_rollouts
        command = self._assist() if by_hand else self.goals.next_command(self.state)
        if not isinstance(command, Twist2D):
            return command
        sent = stack.check(command, by_hand=by_hand)
        self.state = self._sim.step(sent, self.dt)
        stack.observe(self.state)
        self._record(command, sent)
        return None

    def _assist(self) -> Twist2D | Ending:
        """Return what of the command by hand passes the agent's stop check; or how the run ends now."""
        if self.executor is None:
            return Twist2D()
        return self.goals.pass_by_hand(self.state, self.dt) or self.executor.assist()

    def _record(self, command: Twist2D, sent: Twist2D) -> None:
        """Log what was commanded and sent, and where that led; tell the observers."""
        stack, report, goal = self.stack, self.stack.report, self.goals.current
        stack.log.add(self.state, sent, stack.estimate, goal, report.path)
        steering = None if self.executor is None else self.executor.finish_period(command, self.state.time)
        if not (self.returns_steps or self._observers):
            return
        self.last = Step(
            index=len(stack.log) - 1,
            state=self.state,
            command=command,
            goal=goal,
            path=report.path,
            status=report.status,
            sent=sent,
            observation=stack.observation,
            estimate=stack.estimate,
            costmap=report.costmap,
            monitor=stack.monitored,
            tracks=report.tracks,
            rollouts=report.rollouts,
            message=report.message,
            behaviors=report.behaviors,
            tick_s=stack.tick_s,
            planning_s=stack.planning_s,
            steering=steering,
            distance_remaining=report.distance_remaining,
            map=stack.map,
            map_track=stack.map_track,
        )
        self._observers.on_step(self.last)

    def place(self, pose: Pose2D) -> RobotState:
        """Put the robot somewhere else, at rest; its odometry does not notice."""
        placed = self._backend.place(pose)
        self.state = replace(placed, odometry=self.state.odometry, odometry_twist=None)
        self.stack.move_to(self.state)
        return self.state

    def stop(self, message: str, fault: Fault | None) -> None:
        """Stop the loop at the end of the run: report no more physics steps, and refuse directives that wait."""
        if self._watches:
            self._backend.watch_substeps(None)
        if self.executor is not None:
            self.executor.stop(f"the run has ended: {message}", self.state.time, fault)

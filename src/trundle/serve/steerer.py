"""`Steerer`: hands what the driver of the page asks for to the thread that drives a run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import TypeAlias

from trundle.errors import InputError
from trundle.mission import (
    DropBox,
    End,
    Episode,
    LiveRun,
    LiveStatus,
    Manual,
    Pause,
    ReinitializeGlobal,
    Release,
    Restart,
    Session,
    SetGoal,
    SetPose,
    Speed,
    Steering,
    StepOnce,
    WaitAtGoal,
)
from trundle.mission.steering.directives import Directive
from trundle.serve.page_messages import Message, Order
from trundle.serve.run_feed import page_name

MAX_BOXES, MAX_GOALS = 100, 200
"""How many a page may add to one run."""

Refuse: TypeAlias = Callable[[str], None]


class Steerer:
    """Drives a run, and again after restarts, and steers it as the page says.

    Args:
        speed: Speed of the first run relative to real time; infinity for as fast as it can.
        restarts: Whether a page may restart it.
        waits: Whether a run that has arrived waits for the next goal.

    Attributes:
        steering: Where the session of each run takes its directives from.
        session: The session of the last run, or None.
    """

    def __init__(self, *, speed: float = 1.0, restarts: bool = True, waits: bool = False) -> None:
        self.steering = Steering()
        self.session: Session | None = None
        self._speed, self._restarts, self._waits = speed, restarts, waits
        self._live: LiveRun | None = None
        self._by_hand: tuple[int, int] | None = None
        self._added = 0, Counter[str]()

    @property
    def status(self) -> LiveStatus:
        """State of what runs now."""
        return LiveStatus("idle") if self._live is None else self._live.status

    @property
    def runs(self) -> bool:
        """Whether something can be steered now."""
        return self.status.state in ("running", "paused", "waiting")

    # The thread of the run ------------------------------------------------------------------------------------------

    def drive(self, make_session: Callable[[int | None], Session]) -> Episode:
        """Drive to the end, and again after each restart; see `LiveRun`.

        Returns:
            The episode of the last run.
        """

        def make(seed: int | None) -> Session:
            self.session = make_session(seed)
            if self._waits:
                self.steering.put(WaitAtGoal(), by="start")
            return self.session

        self._live = live = LiveRun(make, self.steering, speed=self._speed)
        try:
            return live.run()
        finally:
            self._speed = live.status.speed

    # The server's thread --------------------------------------------------------------------------------------------

    def handle(self, message: Message, client: int, refuse: Refuse) -> None:
        """Pass a request of the driver on to the run; `refuse` gets the reason where that cannot be done."""
        now = self.steering.run  # before it is known that this one runs: another one may begin now
        run = message.run if isinstance(message, Order) and message.run is not None else now
        try:
            if not self.runs:
                raise InputError("nothing runs now")
            if run != now:
                raise InputError(f"run {run} {'has ended' if run < now else 'has not begun'}")
            directive = self._directive(message, client, run)
        except InputError as error:
            refuse(str(error))
            return
        self.steering.put(directive, by=page_name(client), refused=refuse, run=run)

    def let_go(self, client: int) -> None:
        """Stop what this client drives by hand: the robot stands until somebody drives on."""
        driver, run = self._by_hand or (None, 0)
        if driver == client:
            self._by_hand = None
            self.steering.put(Manual(), by=page_name(client), run=run)

    def _directive(self, message: Message, client: int, run: int) -> Directive:
        """Return the directive of a message, as far as this client may give it."""
        match message.directive if isinstance(message, Order) else None:
            case SetGoal() as directive:
                self._count("goals", MAX_GOALS)
                self._by_hand = None
            case Manual() as directive:
                self._by_hand = client, run
            case Release() as directive:
                self._by_hand = None
            case DropBox() as directive:
                self._count("boxes", MAX_BOXES)
            case End():
                directive = End(f"ended by {page_name(client)}")
            case Restart() as directive if self._restarts:
                pass
            case Pause() | StepOnce() | Speed() | SetPose() | ReinitializeGlobal() as directive:
                pass
            case _:
                raise InputError("this cannot be done while something runs: end it first")
        return directive

    def _count(self, what: str, most: int) -> None:
        run, counts = self._added
        if run != id(self.session):
            run, counts = id(self.session), Counter[str]()
            self._added = run, counts
        if counts[what] >= most:
            raise InputError(f"no more than {most} {what} can be added to a run")
        counts[what] += 1

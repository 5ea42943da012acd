"""`RunService`: runs the missions that the driver of the page sets up, one after another."""

from __future__ import annotations

import queue
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Protocol, Self

from trundle.errors import InputError, TrundleError
from trundle.fault import find_fault, folder_of, is_of_plugin, text_of
from trundle.mission import Episode, LiveStatus, Mission, Observer, Restart, Scenario, Session
from trundle.mission.run_files import RECORD
from trundle.mission.setup import make_place
from trundle.serve.choosing import choose
from trundle.serve.hub import Hub
from trundle.serve.page_messages import Message, Order, Preview, Setup
from trundle.serve.run_feed import RunFeed, Watch, scene_message
from trundle.serve.steerer import Refuse, Steerer

_LOOK_S = 0.2  # how often `until` is asked while nothing is requested


class Record(Protocol):
    """Opens what records a run."""

    def __call__(self, mission: Mission, opened: ExitStack) -> tuple[Sequence[Observer], Path | None]:
        """Open it in the stack, which is closed after the run; return the observers and the folder they write."""
        ...


class RunService:
    """Runs missions in the thread that calls it, as the driver of the page says; use it in a `with` block.

    Args:
        hub: Where the pages are; it gets this as its controls.
        base: What the choices of a page change.
        record: Opens what records each run.
        record_failure: Records a run in which a plug-in raised before there was a session.
        speed: Speed of the first run relative to real time; infinity for as fast as it can.
        waits: Whether a run that has arrived waits for the next goal, until a page ends it.

    Attributes:
        failure: What a plug-in raised in the last run, or None.
    """

    def __init__(
        self,
        hub: Hub,
        base: Scenario,
        record: Record,
        record_failure: Callable[[BaseException, Scenario], object],
        *,
        speed: float = 1.0,
        waits: bool = False,
    ) -> None:
        self._hub, self._base, self._record, self._record_failure = hub, base, record, record_failure
        self._steerer = Steerer(speed=speed, waits=waits)
        self._last: Scenario | None = None
        self._requests: queue.SimpleQueue[Message] = queue.SimpleQueue()
        self._is_busy = False
        self._number = 0
        self._opened = ExitStack()
        self._episode: Episode | None = None
        self.failure: BaseException | None = None
        hub.controls = self

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()

    # The thread of the runs -----------------------------------------------------------------------------------------

    def drive(self, scenario: Scenario) -> Episode:
        """Drive a scenario, and again where a page restarts it.

        Its simulator stays open until the next run, or the end of the `with` block.

        Returns:
            The episode of the last run.

        Raises:
            TrundleError: If it cannot be driven.
            BaseException: What a plug-in raised; `failure` has it, too.
        """
        self._is_busy, self._last, self.failure = True, scenario, None
        try:
            self._episode = self._steerer.drive(lambda seed: self._open(scenario, seed))
            return self._episode
        except BaseException as error:
            self.failure = error if is_of_plugin(error) else None
            raise
        finally:
            self._is_busy = False

    def last_episode(self) -> Episode:
        """Return the episode of the last run.

        Raises:
            BaseException: What a plug-in raised in it.
        """
        if self.failure is not None:
            raise self.failure
        if self._episode is None:
            raise InputError("nothing has run yet")
        return self._episode

    def tell(self, error: BaseException) -> None:
        """Show on the pages why something cannot be carried out; what a plug-in raised, with the folder of the run."""
        if not is_of_plugin(error):
            self._hub.announce(text_of(error))
            return
        folder = folder_of(error)
        self._hub.announce(f"{find_fault(error)}" + ("" if folder is None else f"; recorded in {folder}"))

    def serve(self, *, until: Callable[[], bool] | None = None) -> None:
        """Carry out what pages ask for, until Ctrl-C; or, where nothing runs, until this is true."""
        while until is None or not until():
            try:
                request = self._requests.get(timeout=_LOOK_S)
            except queue.Empty:
                continue
            try:
                self._carry_out(request)
            except BaseException as error:
                if not (isinstance(error, TrundleError) or is_of_plugin(error)):
                    raise
                self.tell(error)
            finally:
                self._is_busy = False

    def preview(self, scenario: Scenario) -> None:
        """Show the world of a scenario, in which nothing runs.

        Raises:
            TrundleError: If it cannot be made.
        """
        place = make_place(scenario)
        scene, remark = scene_message(place.world, place.robot, place.grid)
        if remark:
            self._hub.announce(remark)
        self._hub.present(RunFeed(0, scene))

    def _carry_out(self, request: Message) -> None:
        if isinstance(request, Setup):
            self._drive_once(choose(self._base, request))
        elif (restart := _restart_of(request)) is not None and self._last is not None:
            seed = self._last.seed + 1 if restart.seed == "next" else restart.seed
            self._drive_once(self._last if seed is None else self._last.model_copy(update={"seed": seed}))
        elif isinstance(request, Preview):
            self.preview(choose(self._base, request))

    def _drive_once(self, scenario: Scenario) -> None:
        self.drive(scenario)
        session = self._steerer.session
        if session is not None and isinstance(session.error, KeyboardInterrupt):
            raise KeyboardInterrupt

    def _open(self, scenario: Scenario, seed: int | None) -> Session:
        """Make a session of the scenario; what the one before had opened is closed first."""
        self._opened.close()
        if seed is not None:
            scenario = self._last = scenario.model_copy(update={"seed": seed})
        folder: Path | None = None
        try:
            mission = self._opened.enter_context(scenario.build())
            observers, folder = self._record(mission, self._opened)
            self._number += 1
            steering = self._steerer.steering
            watch = Watch(self._hub, self._number, folder, world=lambda: mission.sim.world, steering=steering)
            return mission.session(observers=[watch, *observers, watch.recorded], steering=steering)
        except BaseException as error:
            if is_of_plugin(error) and (folder is None or not (folder / RECORD).is_file()):
                self._opened.close()
                self._record_failure(error, scenario)
            raise

    # The server's thread --------------------------------------------------------------------------------------------

    @property
    def status(self) -> LiveStatus:
        """State of what runs now."""
        return self._steerer.status

    def handle(self, message: Message, client: int, refuse: Refuse) -> None:
        """Carry out a request of the driver; `refuse` gets the reason where that cannot be done."""
        is_setup = isinstance(message, Setup | Preview)
        if not is_setup and (self._steerer.runs or _restart_of(message) is None):
            self._steerer.handle(message, client, refuse)
            return
        try:
            self._ask(message)
        except InputError as error:
            refuse(str(error))

    def let_go(self, client: int) -> None:
        """Stop what this client drives by hand."""
        self._steerer.let_go(client)

    def _ask(self, message: Message) -> None:
        if self._is_busy:
            raise InputError("something runs, or is being prepared: end it first")
        if _restart_of(message) is not None and self._last is None:
            raise InputError("nothing has run yet: set up a run first")
        if isinstance(message, Setup | Preview):
            self._hub.choices.check(message)
        self._is_busy = True
        self._requests.put(message)


def _restart_of(message: Message) -> Restart | None:
    """Return the restart that a message asks for, if it does."""
    return message.directive if isinstance(message, Order) and isinstance(message.directive, Restart) else None

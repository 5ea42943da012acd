"""`NetworkRuns`: what every bridge is between its first run and its end: a wire, a role, and runs one after another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING, Self, TypeAlias

from trundle.mission import Episode, Mission, Observer, Session
from trundle.ros2.inlet import Record
from trundle.ros2.names import Names
from trundle.ros2.role import BridgeContext, Role
from trundle.ros2.wire import Wire

if TYPE_CHECKING:
    from trundle.ros2.transport.transport import Transport
    from trundle.ros2.types import Types

MakeObservers: TypeAlias = Callable[[Mission, int], Sequence[Observer]]
"""Makes what else follows a run, from the mission and the number of the run, from 1."""


class NetworkRuns:
    """Runs on the network of ROS 2; use it in a `with` block.

    A class that derives from it sets `context` and `_role` when it is made, and says in `_own_observers` what of its
    own follows a run.

    Args:
        transport: Carries the bytes; `close` closes it.
        types: The messages.
        names: Namespace and remaps.
        record: Keeps what goes over the wire.
        observers: Makes what else follows each run.
        report: Gets warnings and remarks. If None, the log does.

    Attributes:
        wire: What is published, heard and served.
        context: What the role plugs into.
    """

    context: BridgeContext
    _role: Role

    def __init__(
        self,
        transport: Transport,
        types: Types,
        names: Names,
        *,
        record: Record | None,
        observers: MakeObservers | None,
        report: Callable[[str], None] | None,
    ) -> None:
        self._opened = ExitStack()
        self._observers, self._run, self._is_open = observers, 0, True
        self.wire = Wire(transport, types, names, record=record, report=report)
        self._opened.callback(self.wire.close)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def mission(self) -> Mission:
        """World, robot, map and simulator."""
        return self.context.mission

    def run(self) -> Episode:
        """Drive until the run is ended by a directive, or by Ctrl-C (KeyboardInterrupt); again after each restart.

        Returns:
            The episode of the last run.
        """
        self.wire.start()
        try:
            return self.context.driver.drive(self._begin)
        finally:
            self.close()

    def close(self) -> None:
        """Stop the robot, leave the network and close the simulator; closing twice does nothing."""
        if self._is_open:
            self._is_open = False
            self._opened.close()
            counted = self.wire.warnings.summary()
            if counted:
                self.wire.warnings.note(f"dropped or reported in all: {counted}")

    def _own_observers(self) -> Sequence[Observer]:
        """Return what follows each run before all others."""
        return ()

    def _begin(self, seed: int | None) -> Session:
        self._run += 1
        others = () if self._observers is None else self._observers(self.mission, self._run)
        self.context.session = self._role.begin([*self._own_observers(), *others], seed)
        return self.context.session

"""Actions of the bridge in messages: `Action`, which serves one, and `ActionGoal`, which a client has sent."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from trundle.errors import TrundleError

if TYPE_CHECKING:
    from trundle.ros2.transport.transport import GoalHandle
    from trundle.ros2.types import Types

_LOGGER = logging.getLogger(__name__)


class ActionGoal:
    """A goal that was accepted; any thread may report on it.

    Args:
        handle: The transport's handle of the goal.
        request: The message of the goal.
        type_name: The action's type.
        types: The messages.

    Attributes:
        id: UUID of the goal, 16 bytes.
        request: The message of the goal.
        is_over: Whether it has a result.
    """

    def __init__(self, handle: GoalHandle, request: Any, type_name: str, types: Types) -> None:
        self._handle, self._types, self._type_name = handle, types, type_name
        self.id, self.request = handle.id, request
        self.is_over = False

    @property
    def cancel_requested(self) -> bool:
        """Whether the client wants it to be cancelled."""
        return self._handle.cancel_requested

    def publish_feedback(self, **fields: Any) -> None:
        """Send feedback with these fields; those that the distribution's type lacks are left out."""
        if not self.is_over:
            self._handle.publish_feedback(self._make("Feedback", fields))

    def succeed(self, **fields: Any) -> None:
        """End the goal as succeeded, with these fields of the result."""
        self._end(self._handle.succeed, fields)

    def abort(self, **fields: Any) -> None:
        """End the goal as aborted."""
        self._end(self._handle.abort, fields)

    def canceled(self, **fields: Any) -> None:
        """End the goal as cancelled."""
        self._end(self._handle.canceled, fields)

    def _end(self, end: Callable[[bytes], None], fields: dict[str, Any]) -> None:
        if not self.is_over:
            self.is_over = True
            end(self._make("Result", fields))

    def _make(self, part: str, fields: dict[str, Any]) -> bytes:
        return self._types.encode(self._types.make(f"{self._type_name}_{part}", **fields))


class Action(Protocol):
    """Serves an action; the listening thread calls it."""

    def accepts(self, request: Any) -> bool:
        """Return whether a goal with this message is accepted."""
        ...

    def accepted(self, goal: ActionGoal) -> None:
        """Take a goal; it is ended later, from any thread."""
        ...

    def cancel(self, goal: ActionGoal) -> bool:
        """Return whether a goal will be cancelled as its client asks; it is ended later with `goal.canceled`."""
        ...


class GoalAdapter:
    """Passes the goals of a transport, in bytes, to an action.

    Args:
        type_name: The action's type.
        action: What serves it.
        types: The messages.
        warn: Reports what is refused: its kind, and the text.
    """

    def __init__(self, type_name: str, action: Action, types: Types, warn: Callable[[str, str], None]) -> None:
        self._type_name, self._action, self._types, self._warn = type_name, action, types, warn
        self._goals: dict[bytes, ActionGoal] = {}

    def accepts(self, data: bytes) -> bool:
        """Return whether a goal is accepted."""
        try:
            return self._action.accepts(self._types.decode(f"{self._type_name}_Goal", data))
        except TrundleError as error:
            self._warn(f"{self._type_name}: refused", f"a goal of {self._type_name} is refused: {error}")
        except Exception:  # a goal from outside never ends the bridge
            _LOGGER.exception("a goal of %s could not be read", self._type_name)
        return False

    def accepted(self, goal: GoalHandle) -> None:
        """Pass on a goal that was accepted."""
        self._goals = {key: one for key, one in self._goals.items() if not one.is_over}
        request = self._types.decode(f"{self._type_name}_Goal", goal.data)
        made = self._goals[goal.id] = ActionGoal(goal, request, self._type_name, self._types)
        try:
            self._action.accepted(made)
        except Exception as error:  # the client gets a result, whatever happens
            if not isinstance(error, TrundleError):
                _LOGGER.exception("a goal of %s failed", self._type_name)
            self._warn(f"{self._type_name}: failed", f"a goal of {self._type_name} failed: {error}")
            made.abort()

    def cancel(self, goal: GoalHandle) -> bool:
        """Return whether a goal will be cancelled."""
        made = self._goals.get(goal.id)
        return made is not None and not made.is_over and self._action.cancel(made)

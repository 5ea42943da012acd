"""Stands in for carb.eventdispatcher, and for the event streams of before."""

from __future__ import annotations

import types
import weakref
from collections.abc import Callable
from typing import Any


class Event:
    """A carb event."""

    def __init__(self, name: str, kind: int, payload: object) -> None:
        self.event_name, self.type, self.payload = name, kind, payload


class Subscription:
    """Keeps a callback subscribed as long as it lives, as in Kit."""

    def __init__(self, function: Callable[..., Any], order: int, only: int | None) -> None:
        self.function, self.order, self.only = function, order, only

    def unsubscribe(self) -> None:
        """End it early."""
        self.function = lambda *_, **__: None

    reset = release = unsubscribe


class Events:
    """carb.eventdispatcher, and the streams of before."""

    def __init__(self) -> None:
        self._subscribers: dict[str, list[weakref.ref[Subscription]]] = {}

    def subscribe(
        self, name: str, function: Callable[..., Any], order: int = 0, only: int | None = None
    ) -> Subscription:
        """Call a function at each event of this name; `only` for those of one type."""
        made = Subscription(function, order, only)
        self._subscribers.setdefault(name, []).append(weakref.ref(made))
        return made

    def send(self, name: str, *arguments: object, kind: int | None = None) -> None:
        """Call what has subscribed, in its order; objects that are gone are passed over."""
        alive = [(ref(), ref) for ref in self._subscribers.get(name, ())]
        self._subscribers[name] = [ref for found, ref in alive if found is not None]
        for found in sorted((found for found, _ in alive if found), key=lambda found: found.order):
            if found.only is None or found.only == kind:
                try:
                    found.function(*arguments)
                except ReferenceError:
                    found.unsubscribe()

    def observe_event(
        self, event_name: str = "", on_event: Callable[..., Any] = print, order: int = 0, **_: object
    ) -> Subscription:
        """As in carb.eventdispatcher."""
        return self.subscribe(event_name, on_event, order)

    def dispatch_event(self, event_name: str, payload: object = None) -> None:
        """As in carb.eventdispatcher."""
        self.send(event_name, Event(event_name, 0, payload or {}))

    def stream(self, name: str) -> types.SimpleNamespace:
        """Return an event stream of Kit, for the events of this name."""

        def pop(fn: Callable[..., Any], order: int = 0, name: str = "", stream: str = name) -> Subscription:
            return self.subscribe(stream, fn, order)

        def pop_by_type(
            event_type: int, fn: Callable[..., Any], order: int = 0, name: str = "", stream: str = name
        ) -> Subscription:
            return self.subscribe(stream, fn, order, int(event_type))

        return types.SimpleNamespace(
            create_subscription_to_pop=pop, create_subscription_to_pop_by_type=pop_by_type,
            create_subscription_to_push=pop, create_subscription_to_push_by_type=pop_by_type,
        )  # fmt: skip

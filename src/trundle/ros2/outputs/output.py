"""`Output`: one thing that is published of a run."""

from __future__ import annotations

from typing import Protocol

from trundle.mission import Step


class Output(Protocol):
    """Publishes one thing of a run, where it is wanted."""

    def publish(self, step: Step, time: float) -> None:
        """Publish it for a control period that ends at a time [s] on the network's clock."""
        ...

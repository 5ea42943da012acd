"""An observer that keeps what it is called with."""

from typing import Any


class Recorder:
    def __init__(self):
        self.info: Any = None
        self.episode: Any = None
        self.steps: list[Any] = []

    def on_start(self, run):
        self.info = run

    def on_step(self, step):
        self.steps.append(step)

    def on_end(self, episode):
        self.episode = episode

"""Plug-ins of each kind that raise at a time of their own."""

from trundle.geometry import Twist2D
from trundle.navigation import NavigationStatus

GOAL = (3.0, 4.5)


class Boom(Exception):  # noqa: N818
    pass


class Raising:
    """Raises in one of its methods, in the call number `at` of it."""

    def __init__(self, where, at=1, error=None, returns=Twist2D(0.2, 0.0)):
        self.where, self.at, self.error, self.returns, self.calls = where, at, error or Boom("no idea"), returns, 0

    def _call(self, method):
        if method == self.where:
            self.calls += 1
            if self.calls >= self.at:
                raise self.error


class Agent(Raising):
    """Drives straight on; raises where it is told."""

    def __init__(self, where="update", *given, **options):
        super().__init__(where, *given, **options)

    @property
    def status(self):
        self._call("status")
        return NavigationStatus.DRIVING

    @property
    def behavior_runs(self):
        self._call("behavior_runs")
        return ()

    def reset(self, *, seed=0):
        self._call("reset")

    def set_goal(self, goal):
        self._call("set_goal")

    def set_latency(self, latency):
        self._call("set_latency")

    def update(self, observation, estimate):
        self._call("update")
        return self.returns

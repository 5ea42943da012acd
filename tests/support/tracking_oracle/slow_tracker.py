"""`SlowTracker`: a tracker without the kernel."""

from dataclasses import replace

from support.tracking_oracle.evidence import Evidence
from support.tracking_oracle.followed import Followed
from support.tracking_oracle.sweep import Sweep
from trundle.tracking import Tracker


class SlowTracker(Tracker):
    """As `Tracker`."""

    def _forget(self):
        super()._forget()
        self._followed = Followed(self.settings)
        self._evidence = {}

    def _see(self, placed):
        scan = replace(placed.scan, ranges=placed.ranges)
        sweep = Sweep(scan, placed.poses, self.settings.max_range, self._body)
        evidence = self._evidence.setdefault(scan.lidar, Evidence(self.settings))
        others = [other.latest for lidar, other in self._evidence.items() if lidar != scan.lidar and other.latest]
        self._followed.see(sweep, evidence, others)
        evidence.add(sweep)

    def _predict(self, now):
        return self._followed.tracks(now)

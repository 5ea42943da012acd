"""What the costmap and the tracker ask of one scan is found once, and no other question is."""

import math

import numpy as np
import pytest

from trundle import _core
from trundle.costmap.layers.scan_filter import LoneHits
from trundle.geometry import Pose2D
from trundle.observation import Scan

ANGLES = np.linspace(-math.pi, math.pi, 720, endpoint=False)
HERE, THERE = np.zeros((1, 3)), np.array([[1.0, 0.0, 0.5]])


def scan(time, **beams):
    ranges = np.full(720, 5.0)
    for beam, value in beams.items():
        ranges[int(beam[1:])] = value
    return Scan("front", time, Pose2D(0.0, 0.0), 0.4, ANGLES, ranges, 0.1, 12.0, 0.001)


@pytest.fixture
def calls(monkeypatch):
    made = []
    original = _core.find_lone_hits

    def count(*arguments):
        made.append(arguments)
        return original(*arguments)

    monkeypatch.setattr(_core, "find_lone_hits", count)
    return made


def test_three_that_ask_the_same_make_one_call_for_each_scan(calls):
    users = [(LoneHits(), math.nan), (LoneHits(), math.nan), (LoneHits(), math.inf)]
    for one in (scan(0.0, b100=2.0), scan(0.1, b200=2.0)):
        cleaned = [user.without(one, HERE.copy(), put=put) for user, put in users]
        beam = int(np.flatnonzero(one.ranges == 2.0)[0])
        assert math.isnan(cleaned[0].ranges[beam])
        assert cleaned[2].ranges[beam] == math.inf
        assert (cleaned[0].time, cleaned[0].time_increment) == (one.time, one.time_increment)
        assert not cleaned[0].ranges.flags.writeable
        assert one.ranges[beam] == 2.0
    assert len(calls) == 2


@pytest.mark.parametrize("other", ["place", "scan before", "no scan before"])
def test_another_place_or_scan_before_is_another_question(calls, other):
    now = scan(0.1, b100=2.0)
    before = scan(0.0, b100=2.0)
    first, second = LoneHits(), LoneHits()
    first.without(before, HERE, put=math.nan)
    assert first.without(now, HERE, put=math.nan) is now  # seen before at the same place
    if other != "no scan before":
        second.without(scan(0.0) if other == "scan before" else before, HERE, put=math.nan)
    found = second.without(now, THERE if other == "place" else HERE, put=math.nan)
    assert math.isnan(found.ranges[100])

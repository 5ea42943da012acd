from __future__ import annotations

import pytest

from trundle import World
from trundle.errors import WorldError, WorldWarning
from trundle.worlds.movers import Mover, Waypoints

ACTOR = """<sdf version='1.9'><world name='w'>
<model name='box'><static>true</static><link name='l'><collision name='c'><geometry><box><size>1 1 1</size></box>
</geometry></collision></link></model>
<actor name='walker'><skin><filename>walk.dae</filename></skin><script>{script}</script></actor>
</world></sdf>"""
WALK = """<loop>{loop}</loop><delay_start>{delay}</delay_start><trajectory id='0' type='walk'>
<waypoint><time>0</time><pose>2 0 1 0 0 0</pose></waypoint>
<waypoint><time>{time}</time><pose>4 1 1 0 0 1.5</pose></waypoint></trajectory>"""


def load(tmp_path, script, **options):
    (tmp_path / "w.sdf").write_text(ACTOR.format(script=script))
    return World.load(tmp_path / "w.sdf", **options)


@pytest.mark.parametrize(("loop", "repeat"), [("true", "loop"), ("false", "once")])
def test_an_actor_with_a_trajectory_moves(tmp_path, loop, repeat):
    world = load(tmp_path, WALK.format(loop=loop, delay=2.0, time=3))
    (mover,) = world.movers
    assert isinstance(mover, Mover)
    assert (mover.name, mover.kind) == ("walker", "person")
    motion = mover.motion
    assert isinstance(motion, Waypoints)
    assert motion.points == ((2.0, 2.0, 0.0, 0.0), (5.0, 4.0, 1.0, pytest.approx(1.5)))
    assert (motion.interpolation, motion.repeat) == ("catmull_rom", repeat)


def test_an_actor_without_a_trajectory_is_left_out_with_a_warning(tmp_path):
    with pytest.warns(WorldWarning, match="left out: the actor 'walker'"):
        assert load(tmp_path, "").movers == ()


def test_an_actor_can_be_left_out_by_name(tmp_path):
    assert load(tmp_path, WALK.format(loop="true", delay=0, time=3), exclude="walker").movers == ()


def test_times_that_do_not_increase_are_refused_with_the_line(tmp_path):
    with pytest.raises(WorldError, match=r"w\.sdf:4: .*the actor 'walker': the times of waypoints must increase"):
        load(tmp_path, WALK.format(loop="true", delay=0, time=0))


def test_a_waypoint_without_a_time_is_refused(tmp_path):
    script = "<trajectory><waypoint><pose>0 0 0 0 0 0</pose></waypoint></trajectory>"
    with pytest.raises(WorldError, match="a <waypoint> needs a <time>"):
        load(tmp_path, script)

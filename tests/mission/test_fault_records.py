"""What a run that a plug-in ended leaves: the episode, the folder, the answers to directives."""

import json
import math

import pytest

import trundle
from support.observers import Recorder
from support.raising_plugins import GOAL, Agent, Boom
from support.sessions import steps_of
from trundle.errors import InputError
from trundle.geometry import Twist2D
from trundle.mission import End, Episode, LiveRun, Outcome, Pause, Session, SetGoal, Steering, run
from trundle.record.run_folder import RunFolder
from trundle.sim.kinematic import KinematicSimulator

# Who is told ----------------------------------------------------------------------------------------------------------


def test_a_session_in_steps_raises_once_and_has_the_episode(make_sim, start):
    watcher = Recorder()
    with pytest.raises(Boom) as caught, Session(make_sim(), Agent(at=3), start, GOAL, observers=[watcher]) as session:
        steps_of(session)
    assert (session.outcome, session.error) == (Outcome.ERROR, caught.value)
    assert session.step() is None
    assert session.finish() is session.finish()
    assert session.finish().fault == watcher.episode.fault
    assert len(watcher.steps) == 3


def test_a_robot_that_has_touched_something_still_ends_as_an_error(carter, room, start):
    sim = KinematicSimulator(trundle.World.from_map(room), carter)
    agent = Agent("update", 400, returns=Twist2D(0.8, 0.0))
    session = Session(sim, agent, start, GOAL, stop_on_contact=False, time_limit_s=60.0)
    with pytest.raises(Boom):
        session.run()
    assert session.outcome is Outcome.ERROR
    assert session.finish().metrics.contacts


def test_a_plugin_that_raises_at_a_directive_ends_the_run_and_the_directive_is_refused(make_sim, start):
    steering, refused = Steering(), []
    session = Session(make_sim(), Agent("set_goal", 2, InputError("no")), start, GOAL, steering=steering)
    session.step()
    steering.put(SetGoal((1.0, 1.0)), refused=refused.append)
    with pytest.raises(InputError):
        session.step()
    assert session.outcome is Outcome.ERROR
    assert "the agent Agent raised InputError: no" in refused[0]
    assert session.directives[-1].refused == refused[0]


def test_a_live_run_has_ended_after_an_error_and_refuses_what_waits(make_sim, start):
    steering, refused = Steering(), []
    agent = Agent("update", 3)
    live = LiveRun(lambda _: Session(make_sim(), agent, start, GOAL, steering=steering), steering, speed=math.inf)

    def put(_):
        steering.put(Pause(False), refused=refused.append)
        raise Boom("no idea")

    agent._call = lambda method: put(method) if method == "update" else None
    with pytest.raises(Boom):
        live.run()
    assert live.status.state == "ended"
    assert refused == ["the run has ended"]


def test_a_watcher_that_raises_does_not_cost_the_folder(make_sim, navigator, start, tmp_path):
    class Watcher:
        def begin(self, time):
            pass

        def refuse(self, error):
            pass

        def end(self, end):
            raise Boom("no idea")

    steering = Steering()
    with RunFolder(tmp_path / "run", video=False, overlay=False) as folder:
        session = Session(make_sim(), navigator, start, GOAL, steering=steering, observers=[folder])
        session.step()
        steering.put(SetGoal((1.0, 1.0)), watcher=Watcher())
        session.step()
        steering.put(End())
        with pytest.raises(Boom):
            session.run()
    assert Episode.load(tmp_path / "run").outcome is Outcome.ERROR


def test_records_of_older_versions_have_no_fault(make_sim, navigator, start, tmp_path):
    with RunFolder(tmp_path / "run", video=False, overlay=False, page=False) as folder:
        run(make_sim(), navigator, start, GOAL, observers=[folder])
    file = tmp_path / "run" / "episode.json"
    record = json.loads(file.read_text())
    assert record.pop("fault") is None
    file.write_text(json.dumps(record))
    assert Episode.load(tmp_path / "run").fault is None

import json

import pytest

from support.public_worlds import dynabarn_world
from trundle.errors import InputError, UnknownNameError, WorldError
from trundle.evaluation.episode import EpisodeTask
from trundle.evaluation.public.conditions import Conditions
from trundle.evaluation.public.dynabarn import GOAL, START, check_levels, dynabarn_figures, dynabarn_suite
from trundle.evaluation.statistics import Table

KINEMATIC = Conditions(seeds=2, backends=["kinematic"], drift=False)


def test_worlds_carry_their_level_in_their_label(dynabarn):
    suite = dynabarn_suite(dynabarn, KINEMATIC)
    assert suite.expansion.worlds == ["easy/world_0", "hard/world_3"]
    assert (suite.spec(0).listed.start, suite.spec(0).listed.goal) == (START, GOAL)
    assert suite.spec(0).scenario.rules.every_contact


def test_worlds_are_chosen_by_number_and_level(dynabarn):
    assert dynabarn_suite(dynabarn, KINEMATIC, numbers=[3]).expansion.worlds == ["hard/world_3"]
    assert dynabarn_suite(dynabarn, KINEMATIC, levels=["easy"]).expansion.worlds == ["easy/world_0"]
    with pytest.raises(InputError, match="none of the worlds is medium"):
        dynabarn_suite(dynabarn, KINEMATIC, levels=["medium"])
    with pytest.raises(WorldError, match="no world world_5"):
        dynabarn_suite(dynabarn, KINEMATIC, numbers=[5])
    with pytest.raises(UnknownNameError, match="Did you mean 'hard'"):
        check_levels(["herd"])


def test_the_seed_draws_how_far_the_motions_are(dynabarn):
    suite = dynabarn_suite(dynabarn, KINEMATIC)
    starts = [suite.spec(index).scenario.world.options["start_s"] for index in range(4)]
    assert starts[0] != starts[1]
    assert starts[:2] == starts[2:]  # the same in every world
    assert all(0.0 <= start <= 60.0 for start in starts)
    assert len({suite.spec(index).content for index in range(4)}) == 4


def test_marks_that_no_scan_hits_disappear_soon_but_not_before_the_scans_are_there(dynabarn):
    late = Conditions(seeds=1, backends=["kinematic"], drift=False, scan_age_s=0.2)
    for conditions, expected in ((KINEMATIC, 0.3), (late, 0.5)):
        layers = dynabarn_suite(dynabarn, conditions).spec(0).scenario.layers
        assert layers.obstacle.observation_persistence == pytest.approx(expected)


def test_an_episode_among_distant_obstacles_arrives(dynabarn):
    row = EpisodeTask(dynabarn_suite(dynabarn, KINEMATIC))(0)
    assert (row.outcome, row.world, row.seed) == ("arrived", "easy/world_0", 0)
    assert row.barn_score is None
    table = Table.of([row])
    figures = dynabarn_figures(table)
    assert figures["success_easy"] == 1.0
    assert figures["mean_time_s"] == pytest.approx(row.time_s, abs=1e-6)


def test_an_obstacle_that_runs_into_the_robot_fails_the_run(tmp_path):
    obstacle = {"period_s": 4.0, "waypoints": [[0.0, -10.0, 0.0], [4.0, 30.0, 0.0]]}
    file = tmp_path / "worlds.json"
    file.write_text(json.dumps({"world_0": {**dynabarn_world("hard"), "obstacles": [obstacle]}}))
    rows = [EpisodeTask(dynabarn_suite(file, KINEMATIC))(index) for index in range(2)]
    assert {row.outcome for row in rows} == {"collided"}
    assert {row.standing_contacts for row in rows} == {0}

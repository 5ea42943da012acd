"""Policies beside the navigator: `agents` of a suite, the column `agent` of its rows, and `compare` by it."""

import json

import pytest
import yaml

from support.policies import GOAL_SEEKER, write_policy
from trundle.cli.entry import run_command as main
from trundle.errors import InputError
from trundle.evaluation import Evaluation, Suite
from trundle.evaluation.row import Row
from trundle.evaluation.suite.identity import EpisodeSpec

pytest.importorskip("onnx", reason="makes policies with onnx, of the development tools")
pytest.importorskip("onnxruntime", reason="needs onnxruntime, of the extra policy")

MISSION = {"start": [-10.0, 0.0, 0.0], "goal": [-6.0, 0.0]}


def write_suite(folder, **fields):
    plain = {"worlds": "office", "robots": "nova_carter", "backends": "kinematic", "lidar": True, **fields}
    (folder / "suite.yaml").write_text(yaml.safe_dump({"missions": [MISSION], **plain}))
    return folder / "suite.yaml"


@pytest.fixture
def policy(tmp_path):
    return write_policy(tmp_path / "policy.onnx")


def rows_of(folder):
    return list(Evaluation(folder).rows())


def test_a_policy_is_driven_and_compared_with_the_navigator(tmp_path, policy, capsys):
    suite = write_suite(tmp_path, vary={"lidar_noise": 0.01, "lidar_dropout": 0.01})
    out = tmp_path / "both"
    command = ["evaluate", str(suite), "--agents", f"{policy},navigator", "-o", str(out), "--workers", "1", "--quiet"]
    assert main(command) == 0
    capsys.readouterr()
    policy_row, navigator_row = sorted(rows_of(out), key=lambda row: row.index)
    assert (policy_row.agent, policy_row.controller, policy_row.planner) == ("policy.onnx", "policy.onnx", "none")
    assert (navigator_row.agent, navigator_row.planner) == ("navigator", "none")
    assert policy_row.mission == navigator_row.mission
    assert (policy_row.outcome, navigator_row.outcome) == ("arrived", "arrived")
    alone = tmp_path / "alone"
    assert main(["evaluate", str(suite), "-o", str(alone), "--workers", "1", "--quiet"]) == 0
    capsys.readouterr()
    assert rows_of(alone)[0].agent == "navigator"
    main(["evaluate", "compare", str(alone), str(out), "--json"])
    compared = json.loads(capsys.readouterr().out)
    assert [pair["missions"] for pair in compared["pairs"]] == [1]


def test_the_same_run_has_the_policy_by_its_file(tmp_path, policy, capsys):
    run = [
        *("run", "office", "--start=-10,0,0", "--goal=-6,0", "--lidar", "--backend", "kinematic"),
        *("--agent", str(policy), "-o", str(tmp_path / "run"), "--json"),
    ]
    assert main(run) == 0
    scenario = yaml.safe_load((tmp_path / "run" / "scenario.yaml").read_text())
    assert scenario["agent"] == str(policy)
    assert main(["run", str(tmp_path / "run" / "scenario.yaml"), "-o", str(tmp_path / "again"), "--json"]) == 0
    capsys.readouterr()


def test_a_suite_names_a_policy_beside_itself_and_knows_its_content(tmp_path, policy):
    suite = Suite.load(write_suite(tmp_path, agents=["policy.onnx", "navigator"]))
    assert suite.agents[0].name == str(policy)
    suite.check()
    spec: EpisodeSpec = suite.spec(0)
    assert spec.agent == "policy.onnx"
    (tmp_path / "elsewhere").mkdir()
    moved = write_policy(tmp_path / "elsewhere" / "policy.onnx")
    assert Suite.make(**{**_fields(suite), "agents": [str(moved), "navigator"]}).id_of(0) == spec.id
    write_policy(moved, {**GOAL_SEEKER, "scale": "0.4,0.7"})
    assert Suite.make(**{**_fields(suite), "agents": [str(moved), "navigator"]}).id_of(0) != spec.id


def test_two_policies_of_one_name_are_told_apart_by_their_folders(tmp_path, policy):
    (tmp_path / "b").mkdir()
    other = write_policy(tmp_path / "b" / "policy.onnx", {**GOAL_SEEKER, "scale": "0.4,0.7"})
    suite = Suite.make(worlds="office", agents=[str(policy), str(other)])
    assert [suite.spec(index).agent for index in (0, 1)] == [str(policy), str(other)]


@pytest.mark.parametrize("lidar", [False, ["back"], [True, False]])
def test_a_policy_without_its_lidar_is_refused_before_the_first_episode(policy, lidar):
    fields = {"worlds": "office", "agents": [str(policy), "navigator"]}
    with pytest.raises(InputError, match=r"policy\.onnx: the policy needs scans of the lidar front.*give lidar: true"):
        Suite.make(**fields, lidar=lidar).check()
    with pytest.raises(InputError, match="lidar: false"):
        Suite.make(**fields).check()
    for seeing in ("front", ["front", "back"]):
        Suite.make(**fields, lidar=[seeing]).check()
    Suite.make(**fields, backends=[{"name": "kinematic", "options": {"lidar": True}}]).check()


@pytest.mark.parametrize("period", ["0.033", "0.12", "0.005"])
def test_a_policy_of_any_period_drives(tmp_path, policy, period, capsys):
    write_policy(policy, {**GOAL_SEEKER, "period": period})
    out = tmp_path / "out"
    command = [
        "evaluate",
        str(write_suite(tmp_path)),
        "--agents",
        str(policy),
        "-o",
        str(out),
        "--workers",
        "1",
        "--quiet",
    ]
    assert main(command) == 0
    capsys.readouterr()
    assert [row.outcome for row in rows_of(out)] == ["arrived"]


def test_a_policy_with_a_period_below_a_physics_step_is_refused(tmp_path, policy, capsys):
    write_policy(policy, {**GOAL_SEEKER, "period": "0.001"})
    command = ["evaluate", str(write_suite(tmp_path)), "--agents", str(policy), "-o", str(tmp_path / "out"), "--quiet"]
    assert main(command) == 2
    assert "trundle.period is '0.001': it must be from 0.005" in capsys.readouterr().err


def test_a_requirement_may_name_an_agent(policy):
    fields = {"worlds": "office", "agents": [str(policy), "navigator"], "lidar": True}
    Suite.make(**fields, require="success[agent=policy.onnx]>=0.5").check()
    with pytest.raises(InputError, match="navigator"):
        Suite.make(**fields, require="success[agent=navigatr]>=0.5").check()


def test_a_file_that_is_no_policy_is_refused_before_anything_runs(tmp_path, capsys):
    (tmp_path / "policy.onnx").write_text("nothing")
    suite = write_suite(tmp_path, agents=["policy.onnx"])
    assert main(["evaluate", str(suite), "-o", str(tmp_path / "out"), "--quiet"]) == 2
    assert "this is no ONNX model" in capsys.readouterr().err


def test_rows_of_older_evaluations_have_an_agent():
    old = {"id": "0" * 16, "mission": "m", "index": 0, "world": "w", "robot": "r", "backend": "b", "seed": 0}
    assert Row.of({**old, "planner": "auto", "controller": "mppi", "outcome": "arrived"}).agent == "navigator"
    assert Row.of({**old, "planner": "none", "controller": "mine", "outcome": "arrived"}).agent == "mine"


def _fields(suite):
    return {name: getattr(suite, name) for name in suite.model_fields_set}

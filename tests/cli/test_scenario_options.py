"""`ScenarioOptions.make`: what a verb sets by itself, what a scenario's file says, and what the options say."""

from trundle.cli.shared.scenario_options import ScenarioOptions

INSTEAD = {"lidar": True, "localizer": "slam"}


def made(options: ScenarioOptions, source: str) -> tuple[object, str]:
    scenario = options.make(source, instead=INSTEAD)
    return scenario.lidar, "" if scenario.localizer is None else scenario.localizer.name


def test_what_a_verb_sets_by_itself_stands_where_nothing_else_does(tmp_path):
    file = tmp_path / "own.yaml"
    file.write_text("world: office\nlocalizer: odometry\n")
    assert made(ScenarioOptions(), "office") == (True, "slam")
    assert made(ScenarioOptions(localizer="amcl"), "office") == (True, "amcl")
    assert made(ScenarioOptions(), str(file)) == (True, "odometry")
    file.write_text("world: office\nlidar: front\n")
    assert made(ScenarioOptions(), str(file)) == (("front",), "slam")
    assert made(ScenarioOptions(lidar=False, localizer="odometry"), str(file)) == (False, "odometry")

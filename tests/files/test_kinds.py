import pytest

from trundle.files.kinds import find_kind, kind_of_keys


@pytest.mark.parametrize(
    ("keys", "kind"),
    [
        (["image", "resolution", "origin"], "a map"),
        (["image"], None),
        (["drive", "name"], "a robot"),
        (["model", "limits"], "a robot"),
        (["map", "goal"], "a scenario"),
        (["robot", "world", "drive"], "a scenario"),
        (["name"], None),
        ([], None),
    ],
)
def test_the_kind_of_a_file_follows_from_its_keys(keys, kind):
    assert kind_of_keys(keys) == kind


@pytest.mark.parametrize(
    ("name", "kind"),
    [("a.png", "a picture"), ("a.mp4", "a video"), ("a.sdf", "a world"), ("a.csv", "a table"), ("a.xyz", None)],
)
def test_the_kind_of_an_existing_file_follows_from_its_suffix(tmp_path, name, kind):
    assert find_kind(tmp_path / name) is None
    (tmp_path / name).write_text("")
    assert find_kind(tmp_path / name) == kind


def test_the_kind_of_a_folder_follows_from_its_contents(tmp_path):
    assert find_kind(tmp_path) == "a folder"
    (tmp_path / "drive.csv").write_text("")
    assert find_kind(tmp_path) == "the folder of a drive"
    (tmp_path / "episode.json").write_text("")
    assert find_kind(tmp_path) == "the folder of a run"


def test_the_kind_of_a_yaml_file_follows_from_its_keys(tmp_path):
    file = tmp_path / "some.yaml"
    file.write_text("drive: {}\nlimits: {}\n")
    assert find_kind(file) == "a robot"
    file.write_text("[not: a: mapping")
    assert find_kind(file) is None

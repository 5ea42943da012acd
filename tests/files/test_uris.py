from __future__ import annotations

from pathlib import Path

import pytest

from trundle.files.uris import SEARCH_VARIABLES, describe_search, find_uri


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home folder with nothing in it, and none of Gazebo's and ROS's variables."""
    for name in (*SEARCH_VARIABLES, "GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    return tmp_path / "home"


def make(folder: Path) -> Path:
    folder.mkdir(parents=True)
    return folder


@pytest.mark.parametrize("world", ["repo/worlds", "repo/worlds/hall", "repo"])
def test_models_beside_the_folder_of_worlds_are_found(tmp_path, world):
    shelf = make(tmp_path / "repo" / "models" / "shelf")
    (tmp_path / world).mkdir(parents=True, exist_ok=True)
    assert find_uri("model://shelf", tmp_path / world, ()) == shelf
    assert find_uri("model://bench", tmp_path / world, ()) is None


def test_the_nearest_folder_is_taken_and_given_ones_go_before_the_variables(tmp_path, monkeypatch):
    near, given, far = (make(tmp_path / name / "shelf") for name in ("a/models", "given", "far"))
    base = make(tmp_path / "elsewhere" / "deep" / "below" / "worlds")
    monkeypatch.setenv("GZ_SIM_RESOURCE_PATH", str(tmp_path / "far"))
    assert find_uri("model://shelf", base, ()) == far
    assert find_uri("model://shelf", base, (tmp_path / "given",)) == given
    assert find_uri("model://shelf", make(tmp_path / "a" / "worlds"), (tmp_path / "given",)) == near


@pytest.mark.parametrize(
    ("variable", "entry", "model"),
    [
        ("GZ_SIM_RESOURCE_PATH", "set", "set/shelf"),
        ("GAZEBO_MODEL_PATH", "set", "set/shelf"),
        ("AMENT_PREFIX_PATH", "opt/ros", "opt/ros/share/shop/models/shelf"),
        ("AMENT_PREFIX_PATH", "opt/ros", "opt/ros/share/shelf"),
        ("ROS_PACKAGE_PATH", "src", "src/shop/models/shelf"),
    ],
)
def test_a_model_is_found_by_an_environment_variable(tmp_path, monkeypatch, variable, entry, model):
    found = make(tmp_path / model)
    monkeypatch.setenv(variable, f"{tmp_path / 'none'}:{tmp_path / entry}")
    assert find_uri("model://shelf", make(tmp_path / "w"), ()) == found


@pytest.mark.parametrize(
    ("variable", "entry", "package"),
    [
        ("AMENT_PREFIX_PATH", "opt/ros", "opt/ros/share/shop"),
        ("ROS_PACKAGE_PATH", "src", "src/shop"),
        ("ROS_PACKAGE_PATH", "src/shop", "src/shop"),
        ("ROS_PACKAGE_PATH", "src", "src/stacks/shop"),
        ("GZ_SIM_RESOURCE_PATH", "set", "set/shop"),
    ],
)
def test_a_package_is_found_by_an_environment_variable(tmp_path, monkeypatch, variable, entry, package):
    found = make(tmp_path / package / "meshes")
    monkeypatch.setenv(variable, str(tmp_path / entry))
    assert find_uri("package://shop/meshes", make(tmp_path / "w"), ()) == found


def test_what_gazebo_downloaded_is_found_in_its_newest_version(tmp_path, home, monkeypatch):
    cache = home / ".gz" / "fuel" / "fuel.gazebosim.org" / "openrobotics" / "models" / "ground box"
    for version in ("2", "10", "old"):
        make(cache / version / "meshes")
    address = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground Box"
    for uri, found in (
        (address, cache / "10"),
        (f"{address}/tip", cache / "10"),
        (f"{address}/2", cache / "2"),
        (address.replace(" ", "%20"), cache / "10"),
        (f"{address}/2/files/meshes", cache / "2" / "meshes"),
        (address.replace("fuel.gazebosim.org", "fuel.ignitionrobotics.org"), cache / "10"),
        (f"{address}/3", None),
        (f"{address}/../Other", None),
        ("https://example.org/x", None),
        ("https://[", None),
    ):
        assert find_uri(uri, tmp_path, ()) == found
    moved = make(tmp_path / "cache" / "fuel.gazebosim.org" / "openrobotics" / "models" / "ground box" / "11")
    monkeypatch.setenv("GZ_FUEL_CACHE_PATH", str(tmp_path / "cache"))
    assert find_uri(address, tmp_path, ()) == moved


@pytest.mark.parametrize(
    "uri", ["model://", "model://a\0b", "model://" + "x" * 5000, "ftp://x/y", "", "/" + "y" * 5000]
)
def test_what_cannot_be_a_name_is_not_found(tmp_path, uri):
    found = find_uri(uri, tmp_path / "worlds", ())
    assert found is None or found.is_dir()


def test_the_places_that_were_searched_are_named(monkeypatch):
    monkeypatch.setenv("GAZEBO_MODEL_PATH", "/some/models")
    text = describe_search((Path("mine"),))
    for words in ("--paths (mine)", "GAZEBO_MODEL_PATH=/some/models", "`models`", "not set: GZ_SIM_RESOURCE_PATH"):
        assert words in text

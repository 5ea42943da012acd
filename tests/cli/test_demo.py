from pathlib import Path

from PIL import Image

from support.command_line import Trundle
from trundle.maps import OccupancyGrid


def test_the_demo_arrives_and_leaves_map_picture_and_record(trundle: Trundle) -> None:
    done = trundle("demo", "--no-video", "--json")
    assert done.code == 0, done.err
    assert (done.json["outcome"], done.json["contacts"]) == ("arrived", [])
    folder = Path(done.json["run_dir"])
    assert folder.name.endswith("-demo")
    assert {path.name for path in folder.iterdir()} == {
        "episode.json",
        "map.png",
        "map.yaml",
        "overlay.png",
        "paths.npz",
        "report.html",
        "scenario.yaml",
        "scene.png",
        "trajectory.npz",
    }
    assert (OccupancyGrid.load(folder / "map.yaml").data == 0).any()
    with Image.open(folder / "scene.png") as picture:
        assert picture.size == (1280, 720)

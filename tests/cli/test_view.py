from pathlib import Path

import pytest
from PIL import Image

from support.command_line import Trundle

SMALL = ("--size", "160x90")


def test_a_picture_of_a_robot_alone(trundle: Trundle, tmp_path: Path) -> None:
    done = trundle("view", "nova_carter", "-o", "carter.png", *SMALL, "--json")
    assert done.code == 0, done.err
    assert (done.json["picture"], done.json["width"], done.json["height"]) == ("carter.png", 160, 90)
    with Image.open(tmp_path / "carter.png") as picture:
        assert picture.size == (160, 90)
        assert len(picture.convert("RGB").getcolors(160 * 90)) > 50
    assert sorted(path.name for path in tmp_path.iterdir()) == ["carter.png"]


def test_the_world_is_in_the_picture(trundle: Trundle, tmp_path: Path) -> None:
    assert trundle("view", "nova_carter", "--out", "a", *SMALL).code == 0
    assert trundle("view", "nova_carter", "--out", "b", *SMALL, "--world", "warehouse", "--seed", 3).code == 0
    assert (tmp_path / "a" / "scene.png").read_bytes() != (tmp_path / "b" / "scene.png").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nova_cartr",), "Did you mean 'nova_carter'?"),
        (("nova_carter", "--world", "warehose"), "Did you mean 'warehouse'?"),
        (("nova_carter", "--size", "big"), "give WIDTHxHEIGHT"),
        (("nova_carter", "--size", "0x10"), "1 to 4096 pixels"),
        (("nova_carter", "--size", "99999x10"), "1 to 4096 pixels"),
        (("nova_carter", "--out", "a.jpg"), "ends in .png"),
        (("nova_carter", "--camera", "moon"), "overview"),
    ],
)
def test_bad_input_leaves_nothing(trundle: Trundle, tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    done = trundle("view", *arguments)
    assert done.code == 2
    assert words in done.err
    assert done.out == ""
    assert list(tmp_path.iterdir()) == []

import pytest
from pydantic import Field

from trundle.errors import InputError
from trundle.files.yaml_config import Config, load_config
from trundle.files.yaml_nodes import MAX_BYTES, compose


class Wheel(Config):
    radius: float = Field(gt=0)
    name: str = ""
    spokes: tuple[int, ...] = ()


def read(tmp_path, text):
    path = tmp_path / "wheel.yaml"
    path.write_text(text)
    return load_config(path, Wheel)


def test_numbers_in_scientific_notation_are_numbers(tmp_path):
    assert read(tmp_path, "radius: 5e-2").radius == 0.05


def test_quoted_text_stays_text(tmp_path):
    assert read(tmp_path, 'radius: 1\nname: "5e-2"').name == "5e-2"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("radius: -1", r"wheel.yaml:1:9: radius: -1 is out of range: it must be above 0"),
        ("radius: 1\nspokes: [1, x]", r"wheel.yaml:2:13: spokes.1: must be an integer, got 'x'"),
        ("radius: 1\ncolour: red", r"wheel.yaml:2:1: colour: unknown key. There are: radius, name, spokes"),
        ("name: a", r"wheel.yaml:1:1: radius: is missing"),
        ("radius: .nan", r"wheel.yaml:1:9: radius: "),
        ("radius: .inf", r"wheel.yaml:1:9: radius: "),
        ("radius: 1\nradius: 2", r"wheel.yaml:2:1: the key 'radius' is given twice"),
        ("radius: &a 1\nname: *a", r"wheel.yaml:1:9: anchors and aliases are not accepted"),
        ("radius: [1", r"wheel.yaml:.*: not valid YAML"),
        ("", r"wheel.yaml: the file is empty"),
        ("- 1", r"wheel.yaml:1:1: .*"),
        ("a: 1\n---\nb: 2", r"not valid YAML"),
        (r'radius: "\UFFFFFFFF"', r"not valid YAML"),
        (r'radius: "\U00110000"', r"not valid YAML"),
        ("%YAML 1." + "9" * 5000 + "\n---\nradius: 1", r"not valid YAML"),
    ],
)
def test_every_mistake_is_reported_with_its_place(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        read(tmp_path, text)


def test_all_mistakes_are_reported_at_once_and_unknown_keys_first(tmp_path):
    with pytest.raises(InputError, match=r"colour: unknown key(.|\n)*radius: -1"):
        read(tmp_path, "radius: -1\ncolour: red")


def test_files_that_cannot_be_read_are_named(tmp_path):
    with pytest.raises(InputError, match=r"cannot read .*missing.yaml: no such file"):
        compose(tmp_path / "missing.yaml")
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(InputError, match="not a text file in UTF-8"):
        compose(tmp_path / "binary.yaml")
    (tmp_path / "huge.yaml").write_bytes(b"#" * (MAX_BYTES + 1))
    with pytest.raises(InputError, match="larger than"):
        compose(tmp_path / "huge.yaml")


def test_deep_nesting_is_refused_and_does_not_break_the_interpreter(tmp_path):
    (tmp_path / "deep.yaml").write_text("[" * 50_000)
    with pytest.raises(InputError, match="nested more than 32 levels deep"):
        compose(tmp_path / "deep.yaml")

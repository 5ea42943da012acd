from pathlib import Path

import numpy as np
import pytest

from support.planted_maps import changed, map_of, room, same
from trundle.errors import MapError
from trundle.maps.check import KINDS, check_map


@pytest.fixture
def good(tmp_path: Path) -> Path:
    map_of(room()).save(tmp_path / "map.yaml")
    return tmp_path / "map.yaml"


def rewrite(path: Path, old: str, new: str) -> Path:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    return path


def test_a_good_file_raises_nothing(good):
    report = check_map(good, world=room())
    assert report.findings == ()
    assert report.corrected is None
    assert same(report.grid, map_of(room()))


@pytest.mark.parametrize(
    ("old", "new", "kind", "words"),
    [
        ("negate: 0\n", "", "yaml", "'negate' is missing"),
        ("negate: 0\n", "negate: maybe\n", "yaml", ":5:9: negate is 'maybe'"),
        ("mode: trinary", "mode: trinari", "yaml", ":2:7: mode is 'trinari'"),
        ("resolution: 0.05", "resolution: 0,05", "yaml", ":3:13: resolution is '0,05'"),
        ("resolution: 0.05", "resolution: 0", "resolution", ":3:13: resolution is 0"),
        ("resolution: 0.05", "resolution: -0.05", "resolution", ":3:13:"),
        ("resolution: 0.05", "resolution: .nan", "resolution", ":3:13:"),
        ("occupied_thresh: 0.65", "occupied_thresh: 65", "yaml", ":6:18: occupied_thresh is 65"),
        ("image: map.png", "image: other.png", "yaml", ":1:8: the image file "),
        ("image: map.png", "image: map.yaml", "yaml", "not a PNG, PNM"),
        ("image: map.png", "image: [map.png", "yaml", "not valid YAML"),
    ],
)
def test_what_keeps_a_map_from_loading_is_a_finding(good, old, new, kind, words):
    report = check_map(rewrite(good, old, new), world=room())
    assert [(finding.kind, finding.severity) for finding in report.findings] == [(kind, "error")]
    assert words in report.findings[0].message
    assert report.grid is None
    assert report.corrected is None
    assert report.unverified


def test_all_mistakes_are_reported_at_once(good):
    rewrite(rewrite(good, "negate: 0", "negate: x"), "origin: [", "origin: [1, ")
    assert len([finding for finding in check_map(good).findings if finding.kind == "yaml"]) == 2


@pytest.mark.parametrize(
    ("old", "new", "place", "fix"),
    [
        ("negate: 0\n", "", ":1:1:", "write `negate: 0`"),
        ("negate: 0", "\tnegate: 0", ":5:1:", "spaces for the tab"),
        ("negate: 0", "negate:\t0", ":5:8:", "spaces for the tab"),
        (": ", ":", ":1:1:", "a space after the colon"),
        ("image: map.png", "image: mpa.png", ":1:8:", "image: map.png"),
        ("image: map.png", "image: map.pgm", ":1:8:", "image: map.png"),
        ("image: map.png", "image: map.jpg", ":1:8:", "image: map.png"),
        ("resolution: 0.05", "resolution: [0.05]", ":3:13:", "0.05"),
        ("free_thresh: 0.196", "free_thresh: 0.196\n---\nimage: map.png", ":8:1:", "one document"),
    ],
)
def test_each_mistake_has_its_place_and_its_fix(good, old, new, place, fix):
    (good.parent / "map.jpg").write_bytes(b"\xff\xd8\xff\xe0")
    (finding,) = check_map(rewrite(good, old, new)).findings
    assert (finding.kind, finding.severity) == ("yaml", "error")
    assert place in finding.message
    assert fix in finding.fix


def test_a_yaw_in_degrees_is_warned_of(good):
    text = good.read_text()
    good.write_text(text.replace(", 0.0]", ", 90]"))
    finding = next(finding for finding in check_map(good).findings if finding.kind == "yaml")
    assert finding.severity == "warning"
    assert finding.fix == "write 1.5708"
    good.write_text(text.replace(", 0.0]", ", 90deg]"))
    finding = next(finding for finding in check_map(good).findings if finding.kind == "yaml")
    assert "90deg, which ROS does not read" in finding.message
    assert finding.fix == "write 1.5708"


def test_a_key_of_another_tool_is_a_remark(good):
    (finding,) = check_map(rewrite(good, "negate: 0", "negate: 0\nauthor: me")).findings
    assert (finding.kind, finding.severity) == ("yaml", "info")
    assert ":6:1: the key 'author'" in finding.message


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("mode: trinary", "Mode: trinary", "'mode' is probably meant"),
        ("mode: trinary", "mode: trinary\nmode: raw", ":3:1: the key 'mode' is given twice"),
    ],
)
def test_keys_that_mislead_are_warned_of(good, old, new, words):
    report = check_map(rewrite(good, old, new))
    assert [(finding.kind, finding.severity) for finding in report.findings] == [("yaml", "warning")]
    assert words in report.findings[0].message


def test_exchanged_thresholds_are_put_right(good):
    rewrite(good, "occupied_thresh: 0.65\nfree_thresh: 0.196", "occupied_thresh: 0.196\nfree_thresh: 0.65")
    report = check_map(good)
    assert report.kinds() == {"thresholds_inverted"}
    assert ":7:14:" in report.findings[0].message
    assert same(report.corrected, map_of(room()))


def test_unknown_that_loads_as_free_is_put_right(good):
    data = map_of(room()).data.copy()
    data[20:30, 60:80] = -1
    from support.planted_maps import redrawn

    redrawn(map_of(room()), data).save(good)
    report = check_map(rewrite(good, "free_thresh: 0.196", "free_thresh: 0.25"))
    assert report.kinds() == {"unknown_loads_free", "unknown_hole"}
    assert report.has_errors
    assert "200 unknown cells" in report.findings[0].message
    assert np.array_equal(report.corrected.data, data)


def test_a_high_free_thresh_without_unknown_cells_is_no_trap(good):
    assert check_map(rewrite(good, "free_thresh: 0.196", "free_thresh: 0.25")).findings == ()


@pytest.mark.parametrize("value", ["5", "0.00005"])
def test_an_unlikely_resolution_is_warned_of(good, value):
    report = check_map(rewrite(good, "resolution: 0.05", f"resolution: {value}"))
    assert ("resolution", "warning") in [(finding.kind, finding.severity) for finding in report.findings]


def test_the_kinds_are_those_of_the_contract():
    assert " ".join(KINDS) == (
        "yaml unknown_loads_free thresholds_inverted resolution half_cell flipped rotated shifted negated mismatch "
        "missing_obstacle phantom_obstacle yaw_ignored unknown_hole leak island speckle narrow_door disconnected unseen"
    )


def test_a_file_that_is_not_there_is_no_finding(tmp_path):
    with pytest.raises(MapError, match="no such map file"):
        check_map(tmp_path / "none.yaml")


def test_a_movingai_map_is_checked(tmp_path):
    (tmp_path / "a.map").write_text("type octile\nheight 3\nwidth 4\nmap\n@@@@\n@..@\n@@@@\n")
    assert check_map(tmp_path / "a.map").findings == ()
    (tmp_path / "b.map").write_text("type octile\nheight 3\nmap\n")
    assert check_map(tmp_path / "b.map").kinds() == {"yaml"}


@pytest.mark.parametrize(
    ("old", "new", "kind"),
    [
        ("free_thresh: 0.196", "free_thresh: 0.25", "unknown_loads_free"),
        (
            "occupied_thresh: 0.65\nfree_thresh: 0.196",
            "occupied_thresh: 0.196\nfree_thresh: 0.65",
            "thresholds_inverted",
        ),
        (", 0.0]", ", 1.5707963267948966]", "yaw_ignored"),
    ],
)
def test_what_is_put_right_is_gone_from_the_file_that_is_written(good, tmp_path, old, new, kind):
    changed(map_of(room()), (-2.0, 3.0, -1.0, 4.0, -1)).save(good)
    report = check_map(rewrite(good, old, new))
    assert kind in report.kinds()
    assert kind in report.corrected_kinds
    report.corrected.save(tmp_path / "right.yaml")
    assert check_map(tmp_path / "right.yaml").kinds() == {"unknown_hole"}

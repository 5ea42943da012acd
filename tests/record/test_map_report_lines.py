import pytest

from trundle.maps.check import KINDS, PLACEMENT_KINDS, Finding, MapReport
from trundle.record.map_report_lines import MOST_LINES, tell_report


def finding(kind, severity="warning", fix="mend it", area=None):
    return Finding(kind, severity, f"a {kind}", (1.0, 2.0), fix, area)


@pytest.mark.parametrize("count", range(1, len(KINDS) + 1))
@pytest.mark.parametrize("verified", [True, False])
def test_any_number_of_groups_fits(count, verified):
    findings = tuple(finding(kind) for kind in KINDS[:count] for _ in range(3))
    why = f"{', '.join(PLACEMENT_KINDS)}: no world"
    report = MapReport(findings, () if verified else PLACEMENT_KINDS, remarks=() if verified else (why,))
    lines = tell_report("map", report, None, most=MOST_LINES)
    assert len(lines) <= MOST_LINES
    assert lines[0] == f"map: {3 * count} warnings"
    shown = {
        kind for kind in KINDS[:count] if any(line.startswith(f"warning: {kind} at (1.00, 2.00)") for line in lines)
    }
    hidden = [line for line in lines if line.startswith("and more: ")]
    assert all(kind in shown or kind in hidden[0] for kind in KINDS[:count])
    if 2 * count + 1 + (not verified) <= MOST_LINES:
        assert sum(line == "    fix: mend it" for line in lines) == count
        assert not hidden
    if not verified:
        assert lines[-1] == f"unverified: {why}"
        assert len(tell_report("map", report, None, most=None)) == 2 + 6 * count


def test_the_worst_keep_what_to_do_about_them():
    findings = tuple(finding(kind) for kind in KINDS[:10])
    lines = tell_report("map", MapReport(findings), None, most=MOST_LINES)
    assert [line.startswith("    fix") for line in lines[1:]] == [False, True] * 4 + [False] * 6


def test_what_is_too_small_depends_on_the_robot():
    report = MapReport(
        (finding("island", area=0.2), finding("island", area=0.01), finding("speckle", "info", area=0.01))
    )
    for robot_area, small in ((None, 2), (0.5, 3), (0.001, 0)):
        lines = tell_report("map", report, robot_area, most=MOST_LINES)
        assert any(f"too small for the robot to notice: {small} free areas" in line for line in lines) == bool(small)
        assert len(lines) == 1 + {2: 3, 3: 1, 0: 4}[small]


def test_specks_that_a_robot_would_touch_are_never_too_small():
    report = MapReport((finding("speckle", area=0.0025),))
    assert len(tell_report("map", report, 10.0, most=MOST_LINES)) == 3

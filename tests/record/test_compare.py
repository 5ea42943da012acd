"""Two runs compared: the same one is no distance apart, and a known difference is found."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.record.compare import compare_motions, draw_comparison
from trundle.record.motion import Motion

TIME = np.arange(0.0, 5.001, 0.05)


def circle(time=TIME, *, radius: float = 2.0, w: float = 0.4, start_yaw: float = 0.0) -> Motion:
    yaw = start_yaw + w * time
    x, y = radius * np.sin(yaw), -radius * np.cos(yaw)
    steady = np.full_like(time, w)
    return Motion(time, x, y, np.arctan2(np.sin(yaw), np.cos(yaw)), radius * steady, steady, radius * steady, steady)


def test_a_motion_is_no_distance_from_itself() -> None:
    comparison = compare_motions(circle(), circle())
    assert comparison.max_position_error_m == 0.0
    assert comparison.max_yaw_error_rad == pytest.approx(0.0, abs=1e-12)
    assert comparison.max_command_difference == 0.0


def test_a_known_drift_is_found_where_it_is() -> None:
    drifted = replace(circle(), x=circle().x + 0.02 * TIME, yaw=circle().yaw - 0.01 * TIME)
    comparison = compare_motions(circle(), drifted)
    assert comparison.max_position_error_m == pytest.approx(0.1)
    assert comparison.final_position_error_m == pytest.approx(0.1)
    assert comparison.max_yaw_error_rad == pytest.approx(0.05)
    assert comparison.position_error[50] == pytest.approx(0.05)
    assert comparison.rms_position_error_m == pytest.approx(0.1 / np.sqrt(3.0), rel=0.01)


def test_yaws_are_compared_across_the_half_turn() -> None:
    near = circle(start_yaw=np.pi - 0.001)
    assert compare_motions(near, circle(start_yaw=np.pi + 0.001)).max_yaw_error_rad == pytest.approx(0.002)


def test_a_yaw_is_interpolated_across_the_half_turn() -> None:
    rarer = circle(np.arange(0.0, 5.001, 0.08), start_yaw=2.5)
    assert compare_motions(circle(start_yaw=2.5), rarer).max_yaw_error_rad < 1e-9


def test_other_control_periods_are_compared_at_the_same_times() -> None:
    fine = circle(np.arange(0.0, 5.0005, 0.001))
    comparison = compare_motions(circle(), fine)
    assert comparison.max_position_error_m < 1e-6
    assert comparison.max_command_difference == 0.0
    assert len(comparison.time) == len(TIME)


def test_only_the_time_that_both_have_counts() -> None:
    short = circle(TIME[:40])
    assert compare_motions(circle(), short).time[-1] == pytest.approx(TIME[39])


def test_other_commands_are_said() -> None:
    commanded = replace(circle(), commanded_v=circle().commanded_v + np.where(TIME > 2.0, 0.3, 0.0))
    assert compare_motions(circle(), commanded).max_command_difference == pytest.approx(0.3)


def test_different_starts_are_refused_unless_aligned() -> None:
    turned = circle(start_yaw=1.0)
    with pytest.raises(InputError, match="--align"):
        compare_motions(circle(), turned)
    assert compare_motions(circle(), turned, align=True).max_position_error_m == pytest.approx(0.0, abs=1e-9)


def test_no_time_in_common_is_refused() -> None:
    later = replace(circle(), time=TIME + 100.0)
    with pytest.raises(InputError, match="no time in common"):
        compare_motions(circle(), later)


def test_the_picture_shows_both() -> None:
    drifted = replace(circle(), x=circle().x + 0.05 * TIME)
    picture = draw_comparison(compare_motions(circle(), drifted), ("one", "other"))
    colors = {color for _, color in picture.getcolors(1 << 24) or []}
    assert {(15, 118, 110), (190, 24, 93), (185, 28, 28)} <= colors


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time_s,x\n0,0\n1,1\n", "no column y"),
        ("time_s,x,y,yaw,v,w,command_v,command_w\n0,0,0,0,0,0,0,zero\n", "not a number"),
        ("time_s,x,y,yaw,v,w,command_v,command_w\n0,0,0,0,0,0,0,nan\n1,0,0,0,0,0,0,0\n", "not finite"),
        ("time_s,x,y,yaw,v,w,command_v,command_w\n0,0,0,0,0,0,0,0\n0,0,0,0,0,0,0,0\n", "times must increase"),
    ],
)
def test_a_bad_record_is_refused_by_what_is_wrong(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "drive.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        Motion.load(tmp_path)


def test_a_folder_without_a_record_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"neither trajectory\.npz nor drive\.csv"):
        Motion.load(tmp_path)
    with pytest.raises(InputError, match="no such folder"):
        Motion.load(tmp_path / "none")

import json
import math
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from support.evaluation_rows import make_rows
from trundle.errors import OutputError, UnknownNameError
from trundle.evaluation.report.write import write_reports
from trundle.evaluation.statistics.gates import Gate


def test_it_writes_three_files_that_agree(tmp_path):
    summary = write_reports(tmp_path, make_rows(20), total=500, require=[Gate.parse("success>=0.99")])
    assert json.loads((tmp_path / "summary.json").read_text()) == summary
    assert (summary["episodes"], summary["passed"]) == (80, False)
    assert ElementTree.parse(tmp_path / "junit.xml").getroot().get("tests") == "81"
    page = (tmp_path / "report.html").read_text()
    assert f"<title>{tmp_path.name}" in page
    assert f"trundle run --from {tmp_path}:" in page
    assert sorted(path.name for path in tmp_path.iterdir()) == ["junit.xml", "report.html", "summary.json"]


def test_before_the_first_episode_there_are_reports_as_well(tmp_path):
    assert write_reports(tmp_path, [], total=5, require=[Gate.parse("spl>=0.9")])["complete"] is False


def test_a_label_that_does_not_occur_is_refused_before_anything_is_written(tmp_path):
    with pytest.raises(UnknownNameError, match="Did you mean 'jps'"):
        write_reports(tmp_path, make_rows(2), require=[Gate.parse("success[planner=jp]>=0.9")])
    assert list(tmp_path.iterdir()) == []
    summary = write_reports(tmp_path, make_rows(2), total=900, require=[Gate.parse("success[planner=auto]>=0.9")])
    assert summary["passed"] is False


def test_a_folder_that_is_gone_is_named(tmp_path):
    with pytest.raises(OutputError, match="gone"):
        write_reports(tmp_path / "gone", make_rows(1))


@pytest.mark.parametrize("number", [math.inf, -math.inf, math.nan])
def test_figures_that_are_not_finite_count_as_unknown(tmp_path, number):
    rows = list(make_rows(20))
    broken = dict.fromkeys(("time_s", "min_clearance_m", "end_x", "start_y", "goal_x", "closest_x", "spl"), number)
    for at, outcome in ((0, "arrived"), (1, "stuck")):
        rows[at] = replace(rows[at], outcome=outcome, trail=(number, 1.0, 2.0, number), vary={"mass": number}, **broken)
    summary = write_reports(tmp_path, rows)
    assert summary["episodes"] == 80
    assert math.isfinite(summary["medians"]["time_s"])
    page = (tmp_path / "report.html").read_text()
    assert "nan" not in page.lower().split()
    assert "infinity" not in page.lower()

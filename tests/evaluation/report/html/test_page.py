import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from support.evaluation_rows import make_rows
from trundle.evaluation.report.html.charts import kind_of
from trundle.evaluation.report.html.page import render_page
from trundle.evaluation.row import Row
from trundle.evaluation.statistics.gates import Gate
from trundle.evaluation.statistics.table import Table
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid

_EMPTY = frozenset({"meta", "br", "path", "circle", "rect", "use", "image"})


class Page(HTMLParser):
    """Collects tags, ids and references, and sees to it that every element is closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.text = text
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.words: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        if tag not in _EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)

    @property
    def shown(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.words))


def grid(_key: str = "") -> OccupancyGrid:
    cells = np.zeros((100, 100), np.int8)
    cells[0] = 100
    return OccupancyGrid(cells, 0.25, Pose2D(-12.0, -12.0, 0.0))


def page(rows, require=(), **options) -> Page:
    table = Table.of(rows)
    gates = [Gate.parse(text).judge(table) for text in require]
    return Page(render_page(table, gates=gates, **{"name": "nightly", "folder": "runs/n", "maps": grid, **options}))


def test_the_verdict_comes_first_and_then_what_is_required():
    shown = page(make_rows(100), ["success>=0.5", "success>=0.999"]).shown
    positions = [shown.index(text) for text in ("✕ failed", "success>=0.5", "Success by group", "Compared on the same")]
    assert positions == sorted(positions)
    assert "✓ passed" in page(make_rows(100), ["success>=0.5"]).shown
    assert "? not decided" in page(make_rows(10, failing=(0.0,)), ["success>=0.99"]).shown
    assert "nothing required" in page(make_rows(10)).shown


def test_it_makes_no_request_and_has_no_script():
    found = page(make_rows(40, failing=(0.3, 0.1), vary=True), ["success>=0.5"])
    assert not {"script", "link", "iframe", "object"} & set(found.tags)
    references = [value for _, name, value in found.attributes if name in ("href", "src")]
    assert all(value.startswith(("#", "data:image/png;base64,")) for value in references)
    assert "://" not in found.text
    assert "@import" not in found.text
    assert "url(" not in found.text
    assert not [name for _, name, _ in found.attributes if name.startswith("on")]


def test_every_name_that_is_used_is_defined_once():
    found = page(make_rows(40, failing=(0.3, 0.1)))
    ids = [value for _, name, value in found.attributes if name == "id"]
    used = {value[1:] for tag, name, value in found.attributes if tag == "use" and name == "href"}
    assert len(ids) == len(set(ids))
    assert used <= set(ids)


def test_an_unfinished_evaluation_says_so_at_the_top():
    shown = page(make_rows(10), total=1000).shown
    assert "Unfinished: 40 episodes of 1,000 so far" in shown
    assert "Unfinished" not in page(make_rows(10), total=40).shown
    assert "No episode is done yet" in page([], total=10).shown


def test_failures_near_each_other_are_one_card_with_the_command():
    rows = list(make_rows(40, worlds=("office",), failing=(0.3, 0.0)))
    failed = [row for row in rows if row.outcome != "arrived"]
    found = page(rows)
    assert found.shown.count("near (") == 1
    assert any(f"trundle run --from runs/n:{row.id[:12]}" in found.shown for row in failed)
    assert f"{len(failed) - 1} more like it" in found.shown
    assert all(outcome.replace("_", " ") in found.shown for outcome in {row.outcome for row in failed})


def test_without_a_failure_it_gives_the_bound():
    shown = page(make_rows(381, worlds=("office",), planners=("astar",), failing=(0.0,))).shown
    assert "none in 381: at 95 %, fewer than 1 % fail" in shown
    assert "None: every episode arrived." in shown


def test_crashes_before_the_start_are_shown_with_their_place_in_the_code():
    rows = list(make_rows(5))
    bare = Row(
        id="c" * 16, mission="", index=99, world="office", robot="r", planner="mine", controller="c", backend="k",
        seed=1, outcome="crashed", error="segmentation fault at mine.py:12 in plan",
    )  # fmt: skip
    shown = page([*rows, bare]).shown
    assert "Before the start" in shown
    assert "mine.py:12 in plan" in shown


def test_crashes_after_the_start_are_marked_there():
    blank = dict.fromkeys(("end_x", "end_y", "closest_x", "closest_y", "min_clearance_m", "time_s"))
    rows = [
        replace(row, outcome="crashed", error="aborted", trail=(), **blank)
        for row in make_rows(3, worlds=("office",), planners=("mine",))
    ]
    found = page(rows, maps=lambda _: None)
    assert ("use", "href", "#m-broken") in found.attributes
    assert found.shown.count("near (") == 3


def test_nothing_from_a_file_becomes_markup():
    evil = "<script>alert(1)</script>\"'&"
    evil = "<script>alert(1)</script>\"'&"
    texts = {"world": evil, "touched": evil, "message": evil, "vary": {evil: 1.0}}
    rows = [replace(row, planner=f"{row.planner}{evil}", **texts) for row in make_rows(20, failing=(0.5, 0.1))]
    rows = [replace(row, vary={evil: row.index}, id=f"{row.index:016x}", mission=f"{row.index // 2:x}") for row in rows]
    found = page(rows, name=evil, folder=f"runs/{evil}", facts={evil: evil})
    assert "script" not in found.tags
    assert "alert(1)" in found.shown


def test_the_same_rows_give_the_same_page():
    texts = {page(make_rows(30, failing=(0.3, 0.1), vary=True), ["spl>=0.5"]).text for _ in range(2)}
    assert len(texts) == 1


@pytest.mark.parametrize("maps", [lambda _: None, grid])
def test_worlds_are_drawn_with_and_without_their_maps(maps):
    found = page(make_rows(20, failing=(0.3, 0.1)), maps=maps)
    assert ("image" in found.tags) == (maps is grid)
    assert ("its map is not in this page" in found.shown) == (maps is not grid)


def test_many_worlds_show_those_with_most_failures():
    rows = [
        replace(row, place=f"{row.seed // 2}-{row.world}", world="corridor")
        for row in make_rows(160, failing=(0.3, 0.1))
    ]
    shown = page(rows).shown
    assert "These are the 6 with the most failures of 160 worlds." in shown
    assert re.search(r"corridor, seed \d+", shown)


def test_however_many_fail_the_page_shows_some_and_says_how_many_there_are():
    rng = np.random.default_rng(0)
    rows = [
        replace(row, end_x=float(rng.uniform(-11, 11)), end_y=float(rng.uniform(-11, 11)))
        for row in make_rows(200, worlds=("office",), planners=("a", "b"), failing=(1.1, 1.1))
    ]
    found = page(rows)
    assert found.shown.count("near (") == 24
    assert re.search(r"The 24 largest of \d+ clusters are shown", found.shown)
    assert "1 in 2 failures is marked" in found.shown


def test_a_variation_that_decides_is_named():
    rows = make_rows(300, planners=("astar",), failing=(0.0,), vary=True)
    shown = page(rows).shown
    assert "Success clearly depends on friction (more is better)." in shown
    assert "Success by friction" in shown
    assert "Which variation decides" not in page(make_rows(10)).shown


def test_settings_are_compared_in_tables_and_more_than_three_are_folded():
    found = page(make_rows(10, planners=tuple("abcdef")))
    assert found.tags.count("details") >= 2
    assert "Holm" in found.shown
    assert "Compared" not in page(make_rows(10, planners=("a",))).shown


def test_what_lidars_movers_and_localizers_add_is_shown_where_there_is_some():
    rows = list(make_rows(60))
    assert "error of the estimate" not in page(rows).shown
    sensed = [
        replace(
            row,
            standing_contacts=int(row.index == 3),
            unseen_contacts=0,
            position_error_m=0.25,
            localization_error_m=0.125,
            localization_error_p95_m=0.5,
            lost_s=1.5 if row.index < 2 else 0.0,
            monitor_stops=2,
        )
        for row in rows
    ]
    shown = page(sensed).shown
    assert "run into while standing 1 episodes" in shown
    assert "error of the estimate 0.25 m" in shown
    assert "error while driving 0.125 m mean of the run, median; 95 % of it below 0.5 m" in shown
    assert "not localized 3 s time in which a robot said so; in 2 episodes" in shown
    assert "monitor stops 2 of the collision monitor" in shown
    assert "out of sight" not in shown


@pytest.mark.parametrize("outcome", ["arrived_by_estimate", "finished"])
def test_outcomes_that_are_neither_success_nor_failure_to_drive_have_marks_of_their_own(outcome):
    rows = [replace(row, outcome=outcome) if row.outcome != "arrived" else row for row in make_rows(60, failing=(0.2,))]
    text = page(rows).text
    assert kind_of(outcome) == outcome
    assert f'<g id="m-{outcome}" class="c-{outcome}">' in text
    assert f".c-{outcome}{{" in text
    assert f'href="#m-{outcome}"' in text


def own_worlds(missions):
    for row in make_rows(missions, worlds=("office",), failing=(0.5, 0.3), seed=2):
        yield replace(row, place=f"{row.seed:08x}")


def test_failures_in_worlds_of_their_own_are_a_table_with_thumbnails():
    rows = list(own_worlds(40))
    failed = [row for row in rows if row.outcome != "arrived"]
    found = page(rows)
    assert "Where it fails" not in found.text
    assert found.text.count("</svg></td><th") == len(failed)
    for row in failed:
        assert f"office, seed {row.seed}" in found.shown
        assert row.id[:12] in found.text


def test_few_worlds_have_maps_of_their_failures():
    assert "Where it fails" in page(own_worlds(6)).text

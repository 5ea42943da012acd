"""docs/blog.md: what it says of the blog post's parameters is what its script measures."""

import importlib.util
import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from trundle.cli.entry import run_command
from trundle.control.pursuit_settings import PursuitSettings
from trundle.doctor import check_drive
from trundle.errors import BlockedPoseError
from trundle.geometry import Pose2D
from trundle.mission import Outcome
from trundle.mission.metrics import distances_to_polyline
from trundle.planning import create_planner
from trundle.sim import simulate
from trundle.worlds import World

DOCS = Path(__file__).parents[2] / "docs"
TEXT = " ".join((DOCS / "blog.md").read_text().split())


def quoted(phrase: str) -> float:
    """The number where the page has `{}` in this phrase, which must be there once."""
    found = re.findall(re.escape(phrase).replace(r"\{\}", r"([0-9.]*[0-9])"), TEXT)
    assert len(found) == 1, f"{phrase!r}: {len(found)} times"
    return float(found[0])


def printed(phrase: str) -> object:
    """The same, to be compared with as it is printed: to 0.6 of its last digit's unit."""
    found = re.findall(re.escape(phrase).replace(r"\{\}", r"([0-9.]*[0-9])"), TEXT)
    return pytest.approx(quoted(phrase), abs=0.6 * 10.0 ** -len(found[0].partition(".")[2]))


@pytest.fixture(scope="module")
def post():
    spec = importlib.util.spec_from_file_location("post", DOCS / "pictures" / "post.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["post"] = module
    try:
        spec.loader.exec_module(module)
        yield module
    finally:
        del sys.modules["post"]


@pytest.fixture(scope="module")
def place(post):
    return post.make_place()


@pytest.fixture(scope="module")
def wrong(post):
    return post.drive_as_the_post(post.POST_TRACK)


@pytest.fixture(scope="module")
def right(post):
    return post.drive_as_the_post(post.own_track())


@pytest.fixture(scope="module")
def own(post):
    return post.drive_as_trundle()


def test_in_the_corner_the_robot_stands_in_the_walls(post, place) -> None:
    start, goal = place.corner(post.START_POSE), place.corner(Pose2D(*post.GOAL))
    path = create_planner("manhattan_astar").plan(place.costmap, start, goal)
    assert path.length == printed("corner is {} m long")
    share = 100.0 * place.costmap.footprint_collides(path.poses).mean()
    assert share == printed("at {} % of its poses")
    with simulate(place.world, "nova_carter") as simulator:
        touched = {contact.other for contact in simulator.reset(start).contacts}
    assert touched >= {"wall_south_base", "wall_west_base"}
    with pytest.raises(BlockedPoseError) as error:
        create_planner("least_cost").plan(place.costmap, start, goal)
    assert str(error.value) in TEXT


def test_the_posts_path_leads_through_things_and_trundles_does_not(post, place, right, own) -> None:
    path = right.paths[0]
    assert path.length == printed("4 neighbours, {} m")
    inside = place.costmap.footprint_collides(path.poses)
    steps = np.hypot(*np.diff(path.poses[:, :2], axis=0).T)
    assert steps[inside[1:] & inside[:-1]].sum() == printed("on {} m of it the robot")
    poses = own.paths[0].poses
    assert own.metrics.path_length_m == printed("trundle's is {} m,")
    assert place.costmap.clearance(poses, 2.0).min() == printed("and {} m from everything")


def test_with_the_posts_wheel_base_it_collides_with_the_barrels(wrong) -> None:
    assert wrong.outcome is Outcome.COLLIDED
    assert wrong.metrics.contacts == ("barrels_2_1",)
    assert wrong.metrics.time_s == printed("collides with the barrels after {} s")
    assert np.abs(wrong.trajectory.w).max() == printed("by up to {} rad/s")


def test_with_the_right_track_the_posts_path_still_leads_into_the_forklift(right) -> None:
    assert right.outcome is Outcome.COLLIDED
    assert right.metrics.contacts == ("forklift_2_counterweight",)
    assert right.metrics.time_s == printed("collides with the fork-lift after {} s")
    assert right.metrics.max_cross_track_error_m == printed("takes it {} m off that path")


def test_trundle_arrives_clear_of_everything(own) -> None:
    assert own.outcome is Outcome.ARRIVED
    assert own.metrics.time_s == printed("drives it in {} s")
    assert own.metrics.min_clearance_m == printed("to anything than {} m")
    assert own.metrics.max_cross_track_error_m == printed("from its path than {} m")


def test_trundle_strays_most_where_the_path_begins_beside_its_heading(post, own) -> None:
    begins = np.degrees(own.paths[0].poses[1, 2] - own.start.yaw)
    assert begins == printed("path begins {}° to its left")
    least = PursuitSettings().rotate_to_heading_min_angle
    assert begins < np.degrees(least) == printed("and up to {}°")
    errors = distances_to_polyline(own.trajectory.poses[:, :2], own.paths[0].poses[:, :2])
    assert own.trajectory.time[int(np.argmax(errors))] < 3.0
    turned = post.drive_as_trundle(rotate_to_heading_min_angle=quoted("rotate_to_heading_min_angle: {}`"))
    assert turned.metrics.max_cross_track_error_m == printed("and keeps within {} m")


def test_a_square_becomes_a_triangle(post) -> None:
    over, true = post.drive_square(post.POST_TRACK), post.drive_square(post.own_track())
    turned = np.degrees(np.unwrap(over[:, 2]))[-1] / 4.0
    assert turned == printed("becomes one of {}°")
    assert turned / 90.0 - 1.0 == pytest.approx(quoted("°, {} % too far") / 100.0, abs=0.005)
    assert np.hypot(*over[-1, :2]) == printed("the robot ends {} m from its start")
    assert np.hypot(*true[-1, :2]) == pytest.approx(quoted("it ends {} mm from its start") / 1000.0, abs=0.005)


def test_the_robot_check_names_the_wheel_base_in_the_words_of_the_page(post) -> None:
    with simulate(World("empty", ()), "nova_carter") as simulator:
        configured = simulator.robot.drive.model_copy(update={"track_width": post.POST_TRACK})
        (finding,) = check_drive(simulator, configured=configured).findings
    assert f"{finding.kind}: {finding.message}" in TEXT


@pytest.mark.parametrize(("end", "code"), [("collides", 1), ("arrives", 0)])
def test_the_commands_end_as_the_page_says(
    end: str, code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = re.findall(rf"^trundle (run .*?) +# {end}$", (DOCS / "blog.md").read_text(), re.MULTILINE)
    assert len(found) == 1
    assert run_command([*found[0].split(), "--no-video", "--quiet", "--json", "-o", str(tmp_path)]) == code
    metrics = json.loads(capsys.readouterr().out)
    assert metrics["time_s"] == printed(f": it {end} after {{}} s")
    if end == "collides":
        assert metrics["contacts"] == ["forklift_2_counterweight"]
    else:
        assert metrics["path_length_m"] == printed("with {} m planned")
        assert metrics["min_clearance_m"] == printed("and never nearer than {} m")


def test_its_pictures_are_small_and_new_ones_can_be_made(post, wrong, right, own) -> None:
    names = re.findall(r"\]\(images/(\w+\.png)\)", TEXT)
    assert len(names) == 4
    assert all((DOCS / "images" / name).stat().st_size < 200_000 for name in names)
    assert post.draw_start(wrong, right, own).width > 900
    line = np.zeros((2, 3))
    line[1] = 1.0
    assert post.draw_square(line, line).width > 700

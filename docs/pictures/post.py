"""The pictures of docs/blog.md: the parameters of the blog post on a map of the built-in warehouse, and trundle's own.

    python docs/pictures/post.py [FOLDER]

writes `post_run.png`, `own_run.png`, `post_start.png` and `post_square.png`. tests/docs/test_post.py holds the page's
figures against it.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Self

import numpy as np
from PIL import Image

import trundle
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.mission import Episode
from trundle.pictures.colors import BAD, PAGE, PLANNED, START, WARNING
from trundle.record.compare import Chart, Curve, draw_chart
from trundle.record.map_view import MapView
from trundle.record.overlay import draw_run
from trundle.record.page import Mark, compose_page
from trundle.record.run_folder import save_png
from trundle.robots import Robot
from trundle.sim import RobotState, Simulator

POST_TRACK = 0.54
POST_ANGULAR_SPEED = 1.5
POST_LOOKAHEAD = 0.7
SETTINGS = trundle.NavigatorSettings(planning_deadline_s=None)
START_POSE, GOAL = Pose2D(-14.0, -9.0), (14.0, 9.0)
"""A metre and a bit from two corners of the warehouse that lie across."""

_PERIOD = 0.05


class OtherTrack:
    """A robot whose wheels are commanded with another track than it has.

    Its limits apply to commands, as in Isaac Sim's DifferentialController: the robot turns faster than that.
    """

    def __init__(self, world: trundle.World, robot: Robot, track_width: float) -> None:
        over = track_width / robot.drive.track_width
        limits = robot.limits.model_copy(
            update={
                "angular_speed": over * robot.limits.angular_speed,
                "angular_acceleration": over * robot.limits.angular_acceleration,
            }
        )
        self.robot, self.world = robot, world
        self._commanding = robot.drive.model_copy(update={"track_width": track_width})
        self._simulator: Simulator = trundle.simulate(world, robot.model_copy(update={"limits": limits}))

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """See `Simulator`."""
        return self._simulator.reset(pose, seed=seed)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Turn the wheels as the other track wants it."""
        wheels = self._commanding.wheel_speeds(self.robot.limits.clamp(command))
        return self._simulator.step(self.robot.drive.twist(wheels), dt)

    def close(self) -> None:
        """See `Simulator`."""
        self._simulator.close()

    def __enter__(self) -> Self:
        """See `Simulator`."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close."""
        self.close()


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """The warehouse and its map."""

    world: trundle.World
    grid: trundle.OccupancyGrid
    costmap: Costmap

    def corner(self, pose: Pose2D) -> Pose2D:
        """The centre of the free cell that is farthest in a pose's direction from the middle: into its corner."""
        rows, cols = np.nonzero(self.grid.data == 0)
        x, y = self.costmap.cell_to_world(rows, cols)
        best = int(np.argmax(np.sign(pose.x) * x + np.sign(pose.y) * y))
        return Pose2D(float(x[best]), float(y[best]))


@cache
def make_place() -> Place:
    """Build the warehouse and map it as Nova Carter sees it."""
    world, robot = trundle.World.generate("warehouse", seed=7), Robot.load("nova_carter")
    grid = trundle.OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
    return Place(world, grid, Costmap.from_grid(grid, robot.outline))


def post_robot() -> Robot:
    """Nova Carter with the speeds that the post gives its controller."""
    robot = Robot.load("nova_carter")
    limits = robot.limits.model_copy(update={"angular_speed": POST_ANGULAR_SPEED})
    return robot.model_copy(update={"limits": limits})


def drive_as_the_post(track_width: float) -> Episode:
    """Drive with the post's planner and follower, and wheels commanded with some track."""
    place, robot = make_place(), post_robot()
    navigator = trundle.Navigator(
        place.grid,
        robot,
        planner="manhattan_astar",
        controller=trundle.Choice.of("lookahead", lookahead_dist=POST_LOOKAHEAD),
        settings=SETTINGS,
    )
    with OtherTrack(place.world, robot, track_width) as simulator:
        name = f"the post's planner and follower, wheel base {track_width:g} m"
        return trundle.run(simulator, navigator, START_POSE, GOAL, name=name)


def drive_as_trundle(**controller_options: float) -> Episode:
    """Drive with the defaults of `trundle run`, except for options of the controller."""
    place, robot = make_place(), Robot.load("nova_carter")
    controller = trundle.Choice.of("regulated_pure_pursuit", **controller_options)
    navigator = trundle.Navigator(place.grid, robot, controller=controller, settings=SETTINGS)
    with trundle.simulate(place.world, robot) as simulator:
        return trundle.run(simulator, navigator, START_POSE, GOAL, name="trundle's own")


def drive_square(track_width: float) -> FloatArray:
    """Command four times 2 m and a quarter turn, open-loop by time; return the poses, shape (N, 3)."""
    robot = post_robot()
    side, turn = (Twist2D(0.4, 0.0), 5.0), (Twist2D(0.0, np.pi / 8.0), 4.0)
    rest = (Twist2D(), 0.5)
    with OtherTrack(trundle.World("empty", ()), robot, track_width) as simulator:
        poses = [simulator.reset(Pose2D(0.0, 0.0)).pose.as_tuple()]
        for command, seconds in [side, rest, turn, rest] * 4:
            steps = range(round(seconds / _PERIOD))
            poses.extend(simulator.step(command, _PERIOD).pose.as_tuple() for _ in steps)
    return np.array(poses)


def draw_start(wrong: Episode, right: Episode, own: Episode) -> Image.Image:
    """Draw the first metres of all three, with the robot at the start and where it collided."""
    place, robot = make_place(), post_robot()
    view = MapView(place.costmap, np.array([[-15.0, -10.0], [-10.5, -5.5]]))
    path = right.paths[0].poses
    view.line(path[:, :2], PLANNED, 9)
    for pose in path[place.costmap.footprint_collides(path)][::4]:
        view.outline(Pose2D(*pose.tolist()), robot.outline, BAD, 1, alpha=90)
    driven = [(own, START), (right, WARNING), (wrong, BAD)]
    for episode, color in driven:
        view.line(episode.trajectory.poses[:, :2], color, 5)
    for episode, color in driven[1:]:
        end = Pose2D(*episode.trajectory.poses[-1].tolist())
        view.outline(end, robot.outline, color, 3, fill=70)
        view.cross((end.x, end.y), 13, color, 5)
    view.outline(START_POSE, robot.outline, START, 2.5, fill=50)
    return compose_page(
        view.finish(),
        title="the first metres",
        status=None,
        lines=["thin red outlines: the post's path, where the robot would stand in something"],
        legend=[
            Mark("line", PLANNED, "the post's path"),
            Mark("line", BAD, f"wheel base {POST_TRACK:g} m"),
            Mark("line", WARNING, f"the right {robot.drive.track_width:g} m"),
            Mark("line", START, "trundle's own"),
        ],
        pixels_per_metre=view.pixels_per_metre,
    )


def draw_square(wrong: FloatArray, right: FloatArray) -> Image.Image:
    """Draw the square as commanded and as driven with both tracks."""
    commanded = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]])
    curves = [
        Curve(commanded[:, 0], commanded[:, 1], PLANNED, "commanded", 11),
        Curve(wrong[:, 0], wrong[:, 1], BAD, f"wheel base {POST_TRACK:g} m", 4),
        Curve(right[:, 0], right[:, 1], START, f"track {own_track():g} m", 4),
    ]
    chart = draw_chart(Chart("a square of 2 m [m]", curves, square=True), (720, 640))
    page = Image.new("RGB", (chart.width + 32, chart.height + 32), PAGE)
    page.paste(chart, (0, 16))
    return page


def own_track() -> float:
    """Nova Carter's own track [m]."""
    return Robot.load("nova_carter").drive.track_width


def main(folder: Path) -> None:
    """Write the pictures, and print how each run ended."""
    costmap, robot = make_place().costmap, post_robot()
    wrong, right, own = drive_as_the_post(POST_TRACK), drive_as_the_post(own_track()), drive_as_trundle()
    save_png(draw_run(costmap, robot, wrong), folder / "post_run.png")
    save_png(draw_run(costmap, robot, own), folder / "own_run.png")
    save_png(draw_start(wrong, right, own), folder / "post_start.png")
    save_png(draw_square(drive_square(POST_TRACK), drive_square(own_track())), folder / "post_square.png")
    for episode in (wrong, right, own):
        print(f"{episode.name}: {episode.message}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "images")

"""`show`: the page in a browser for a loop of one's own."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Mapping
from html import escape
from types import EllipsisType, TracebackType
from typing import Self

import numpy.typing as npt

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import LiveStatus, SetGoal, SetPose
from trundle.mission.steering.queue import DEAD_MAN_S
from trundle.observation import Estimate, Scan
from trundle.robots import Robot
from trundle.serve import opening
from trundle.serve.choosing import Choices
from trundle.serve.hub import Hub
from trundle.serve.page_messages import Keys, Message, Order, encode_message
from trundle.serve.run_feed import scene_message
from trundle.serve.server import TICK_S
from trundle.serve.steerer import Refuse
from trundle.serve.view_arguments import (
    AnyPath,
    AnyPose,
    AnyScans,
    Belief,
    read_belief,
    read_paths,
    read_place,
    read_poses,
    read_scans,
    read_text,
)
from trundle.serve.view_feed import Shown, ViewFeed
from trundle.values import check_kind
from trundle.worlds import World


def show(
    world: World | OccupancyGrid | str | os.PathLike[str] | None,
    robot: Robot | str | os.PathLike[str],
    *,
    open_browser: bool = True,
) -> View:
    """Open the page in a browser for a loop of one's own: it shows what the loop gives, and returns goals and keys.

        with trundle.show(world, robot) as view:
            while True:
                view.update(pose, path=path, scan=scans, text="driving")

    The page is served as by `trundle serve`: to this machine alone, and to whoever has the printed address with its
    token. A loop never waits for a page.

    Args:
        world: What is around the robot: a world, a map, the name of a built-in world, the file of a world or a map, or
            None for an empty floor.
        robot: The robot, its name or its file. Several robots of a view look alike.
        open_browser: Open the page, where there is a screen; in a notebook, where the view shows itself, it is not
            opened. The address is printed in any case.

    Returns:
        The view; use it in a `with` block, or close it.

    Raises:
        UnknownNameError: If a name is not known; the nearest is offered.
        InputError: If it is no world or robot, or its file cannot be used.
    """
    machine = Robot.load(robot)
    place, grid = read_place(world, machine)
    view = View(place, machine, grid)
    said = [f"The page: {view.address}"]
    if opening.is_remote():
        said.append(f"On your own machine: {opening.forwarding(view.port)}, then open that address there")
    elif open_browser and "ipykernel" not in sys.modules and not opening.open_browser(view.address):
        said.append("No browser was found here: open that address in one")
    print(*said, sep="\n", flush=True)  # noqa: T201 - the address, with its token, is for the person alone
    return view


class View:
    """The page of a loop; `show` makes one.

    Args:
        world: The world that is drawn, or None.
        robot: The robot.
        grid: The map that is drawn, or None.

    Attributes:
        address: The address of the page, with its token.
        port: The port that it is served on.
    """

    def __init__(self, world: World | None, robot: Robot, grid: OccupancyGrid | None) -> None:
        self._hub = Hub(choices=Choices(None))
        self._input = self._hub.controls = PageInput()
        scene, remark = scene_message(world, robot, grid)
        self._feed = ViewFeed(scene, robot, "" if world is None else world.name)
        self._hub.present(self._feed)
        if remark:
            self._hub.announce(remark)
        self._server = opening.start_server(self._hub, opening.make_page("view"))
        self.address, self.port = self._server.address, self._server.port
        self._began_s = time.monotonic()
        self._shown = Shown(0.0, {}, {}, (), None, "", None)
        self._scans: dict[tuple[str, str], tuple[Scan, Pose2D]] = {}
        self._belief = Belief()
        self._is_open = True

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"View({self.address}, {'open' if self._is_open else 'closed'})"

    def _repr_html_(self) -> str:
        """Show the page in notebooks."""
        if not self._is_open:
            return "<p>The view is closed.</p>"
        address = escape(self.address.replace("/?token=", "/frame?token="))
        return f'<iframe src="{address}" title="trundle" width="100%" height="720" style="border: 0"></iframe>'

    # What the loop shows --------------------------------------------------------------------------------------------

    def update(
        self,
        pose: AnyPose | Mapping[str, AnyPose],
        *,
        path: AnyPath | Mapping[str, AnyPath | None] | EllipsisType | None = ...,
        scan: AnyScans | Mapping[str, AnyScans] | EllipsisType | None = ...,
        costmap: Costmap | EllipsisType | None = ...,
        text: str | EllipsisType = ...,
        estimate: Estimate | EllipsisType | None = ...,
        covariance: npt.ArrayLike | EllipsisType | None = ...,
        particles: npt.ArrayLike | EllipsisType | None = ...,
    ) -> None:
        """Draw this from now on; it returns at once, whether there is a page or not.

        What is not given stays as it was, and None removes it. Pages get at most 20 updates and 2 costmaps in a second,
        the newest; a slow connection gets fewer.

        Args:
            pose: Pose of base_link in the map frame [m, rad]: a pose, (x, y) or (x, y, yaw); of several robots {name:
                pose}, of all that are there now.
            path: Where the robot is to drive: a path, or points [m] in the map frame, shape (N, 2) or (N, 3). Of
                several robots {name: path}.
            scan: One scan or several, measured at this pose. The newest of each lidar stays, so that scans may come
                more rarely than poses. Of several robots {name: scan}.
            costmap: The costmap.
            text: The headline, such as what the loop does.
            estimate: What a localizer believes of a single robot, where that is not the pose: both are drawn, with its
                covariance, its particles, the other places and its state.
            covariance: Covariance of (x, y, yaw) of the estimate, or of the pose where there is none [m², rad²], shape
                (3, 3): the ellipse is drawn that holds 95 % of positions.
            particles: (x, y, yaw) of particles [m, m, rad], map frame, shape (N, 3), or (N, 4) with weights; at most
                500 of them are drawn.

        Raises:
            InputError: If the view is closed, or something is of another kind.
        """
        if not self._is_open:
            raise InputError("this view is closed: update it inside its with block, or open another with trundle.show")
        before, poses = self._shown, read_poses(pose)
        if path is ...:
            paths = before.paths
            if not paths.keys() <= poses.keys():
                paths = {name: points for name, points in paths.items() if name in poses}
        else:
            paths = read_paths(path, poses)
        if costmap is not ... and costmap is not None:
            check_kind(costmap, Costmap, "costmap", "of a map make one with trundle.Costmap.from_grid(grid, robot)")
        headline = before.text if text is ... else read_text(text)
        scans = self._scans if scan is ... else {} if scan is None else self._scans | read_scans(scan, poses)
        belief = read_belief(self._belief, estimate, covariance, particles)
        believed, self._belief = belief.of(poses), belief
        self._scans = {key: value for key, value in scans.items() if key[0] in poses}
        self._shown = Shown(
            time=time.monotonic() - self._began_s,
            poses=poses,
            paths=paths,
            scans=tuple((name, one, at) for (name, _), (one, at) in self._scans.items()),
            costmap=before.costmap if costmap is ... else costmap,
            text=headline,
            goal=self._input.goal,
            belief=believed,
        )
        self._feed.show(self._shown)

    # What the page returns ------------------------------------------------------------------------------------------

    @property
    def goal(self) -> Goal | None:
        """The goal that was clicked last, map frame; None before the first click.

        It stays, and is marked on the page, until another one is clicked or set. Setting it marks a goal of the loop;
        None removes the mark.
        """
        return self._input.goal

    @goal.setter
    def goal(self, goal: Goal | Pose2D | tuple[float, ...] | None) -> None:
        self._input.set_goal(None if goal is None else Goal.of(goal))

    def take_goal(self) -> Goal | None:
        """Return the goal that was clicked since the last call, the last of several; None if none was.

        So each click is acted on once; `goal` stays.
        """
        return self._input.take_goal()

    def take_pose(self) -> Pose2D | None:
        """Return the pose that was given on the page since the last call, the last of several; None if none was.

        The page has "Set pose" where the loop gives what its robot believes (`estimate`, `covariance` or `particles` of
        `update`). Tell it to the localizer, with a covariance of what a hand can point at, such as RViz's: 0.25 m² of x
        and y, 0.0685 rad² of yaw.
        """
        return self._input.take_pose()

    @property
    def keys(self) -> frozenset[str]:
        """The keys that are held on the page that drives, such as "w", "ArrowUp" or " "; letters in lower case.

        The page tells them again and again. Where it does not, because the connection is lost, it is closed, hidden or
        busy, they count as let go after 0.3 s: a robot that is driven by them stops.
        """
        return self._input.keys

    def close(self) -> None:
        """Tell the pages that the loop has ended, and stop serving them; closing twice does nothing."""
        if not self._is_open:
            return
        self._is_open = False
        self._input.let_go(None)
        self._feed.end = encode_message("end", outcome="ended", message="")
        if len(self._hub):
            time.sleep(2.0 * TICK_S)  # for the pages to get it
        self._server.close()


class PageInput:
    """What the page that drives has asked for: the controls of the hub of a view."""

    status = LiveStatus("running")

    def __init__(self) -> None:
        self._changing = threading.Lock()
        self._goal: Goal | None = None
        self._clicked: Goal | None = None
        self._pose: Pose2D | None = None
        self._keys: tuple[frozenset[str], float, int] = frozenset(), 0.0, 0

    @property
    def goal(self) -> Goal | None:
        """The newest goal."""
        return self._goal

    @property
    def keys(self) -> frozenset[str]:
        """The keys that are held."""
        held, told_s, _ = self._keys
        return held if time.monotonic() - told_s <= DEAD_MAN_S else frozenset()

    def set_goal(self, goal: Goal | None) -> None:
        """Replace the goal by one of the loop."""
        with self._changing:
            self._goal, self._clicked = goal, None

    def take_goal(self) -> Goal | None:
        """Return what was clicked, once."""
        with self._changing:
            clicked, self._clicked = self._clicked, None
        return clicked

    def take_pose(self) -> Pose2D | None:
        """Return the pose that was given, once."""
        with self._changing:
            pose, self._pose = self._pose, None
        return pose

    def handle(self, message: Message, client: int, refuse: Refuse) -> None:
        """Apply a goal, a pose or keys of the page that drives."""
        if isinstance(message, Keys):
            self._keys = frozenset(message.held), time.monotonic(), client
        elif isinstance(message, Order) and isinstance(message.directive, SetGoal):
            with self._changing:
                self._goal = self._clicked = Goal.of(message.directive.goal)
        elif isinstance(message, Order) and isinstance(message.directive, SetPose):
            with self._changing:
                self._pose = message.directive.target
        else:
            refuse("this page takes goals, poses and keys alone")

    def let_go(self, client: int | None) -> None:
        """Forget the keys of this client, or of any."""
        if client is None or self._keys[2] == client:
            self._keys = frozenset(), 0.0, 0

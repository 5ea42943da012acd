"""`Mapper`: makes a map from scans and odometry, and says where the robot is on it.

The front end matches each scan with the last key frames. Key frames are the nodes of a pose graph; places that the
robot comes back to become loops in it, and its corrected poses are the map. Every choice follows from the data alone,
so the same observations give the same map.
"""

from __future__ import annotations

import math
import os
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.beams import BeamPicker
from trundle.localization.localizer import check_covariance
from trundle.mapping.doubtful_scans import CarriedAway, MovingThings
from trundle.mapping.drawing import LiveMap
from trundle.mapping.key_frames import RecentSurfaces, SeenPlaces, Travel, doubt_of, motion_spread, turned
from trundle.mapping.loops import Loop, LoopFinder
from trundle.mapping.nodes import MOST_POINTS, Floating, Nodes, Surface, make_surface
from trundle.mapping.parts import component_of, contradicts, fits, is_true, join_parts, nearest_joined, optimize
from trundle.mapping.pose_graph import FARTHEST_M, FOLLOWS, LOOP, PoseGraph
from trundle.mapping.pose_graph_file import load_pose_graph, save_pose_graph
from trundle.mapping.submaps import Submaps
from trundle.mapping.window import Match, ScanWindow
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Observation
from trundle.robots import Robot
from trundle.values import check_count, check_kind, check_number

_LEAST_M, _LEAST_RAD = 0.02, math.radians(0.5)  # less motion than that is not worth a match
_KEPT_M, _KEPT_RAD = 0.10, math.radians(5.0)  # scans that the map is drawn from
_KEY_M, _KEY_RAD = 0.4, math.radians(20.0)  # between key frames, which the graph and its loops are made of
_EDGE_FLOOR = np.diag((0.008**2, 0.008**2, math.radians(0.1) ** 2))  # no edge of the graph is surer [m², rad²]
_LOST_FIT, _SHORTEST_M = 0.2, 0.01  # scans that fit worse show another place; the least range that may be asked for
_LOOP_EVERY, _MOST_LATE = 2, 10  # one in so many key frames is compared with old ones; loops that need no solving
_LEAP_M = 100.0  # what was seen before and after a step of this length has nothing in common
_BY_HAND = np.diag((0.25**2, 0.25**2, math.radians(5.0) ** 2))  # of a pose that somebody told [m², rad²]
_LOST_VARIANCES = (1.0, 1.0, 1.0)  # [m², rad²]
_NOTHING = Surface(*np.empty((3, 0, 2)))


class Mapper:
    """Maps while the robot drives.

    Args:
        robot: The robot; beams that end on its own body are left out.
        seed: Seed of random choices; there are none now, and the map follows from the observations alone.
        max_range: The longest beams that are used [m]; None for as long as each lidar measures.

    Attributes:
        revision: How often the map has changed by more than what is new: poses were corrected, a part was joined, or
            another part began. It never goes back.
    """

    def __init__(self, robot: Robot, *, seed: int = 0, max_range: float | None = None) -> None:
        check_kind(robot, Robot, "a mapper's robot", "Robot.load(name) makes one")
        if max_range is not None:
            max_range = check_number("max_range, or None for the lidar's own,", max_range, _SHORTEST_M, math.inf, "m")
        self.robot = robot
        self.seed = check_count("seed", seed, 0, 2**63 - 1)
        self._longest = FARTHEST_M if max_range is None else min(max_range, FARTHEST_M)
        self.revision = 0
        self._begin(Nodes(robot), Pose2D(0.0, 0.0))

    def _begin(self, nodes: Nodes, start: Pose2D) -> None:
        self._nodes = nodes
        self._submaps = Submaps(nodes)
        self._loops = LoopFinder(nodes, self._submaps)
        self._live: LiveMap | None = None
        self._picker = BeamPicker(self.robot, MOST_POINTS, self._longest)
        self._key_frames = 0
        self._late = 0  # loops since the graph was solved
        self._places = SeenPlaces()
        for node in range(len(nodes)):
            self._places.add(nodes.pose(node))
        self._part = max(nodes.parts, default=-1)
        self._begin_part(start)

    def _begin_part(self, start: Pose2D | None = None) -> None:
        self._part += 1
        self._start = Pose2D(0.0, 0.0) if start is None else start  # of the window's frame
        self._told: FloatArray | None = None  # covariance of a start on the map, until there is a node
        self._off: FloatArray = np.zeros((3, 3))  # where the part lies on the map, until it recognises something
        self._is_apart = len(self._nodes) > 0  # what joins it to the first part has not been seen yet
        self.revision += self._is_apart  # nothing lies where the robot believes it to be any more
        self._window = ScanWindow()
        self._moving = MovingThings(self.robot)
        self._recent = RecentSurfaces()
        self._carried = CarriedAway(self._longest)
        self._floats: Floating | None = None  # the last node, where it stands for many
        self._key: tuple[int, Pose2D] | None = None  # the last node, and its pose in the frame of the window
        self._last: tuple[Pose2D, Pose2D] | None = None  # the last match: odometry, and pose in the frame of the window
        self._kept: Pose2D | None = None
        self._before: tuple[Pose2D, Pose2D] | None = None  # the first odometry, and pose in the frame of the window
        self._spread: FloatArray = np.diag((1e-6, 1e-6, 1e-6))
        self._poor = 0
        self._worst = 1.0  # fit since the last node
        self._travel = Travel(self._nodes.travelled[-1] if len(self._nodes) else 0.0)

    @classmethod
    def from_graph(cls, graph: PoseGraph, robot: Robot, *, seed: int = 0, max_range: float | None = None) -> Mapper:
        """Continue a pose graph with a new part, which is joined when it recognises something."""
        check_kind(graph, PoseGraph, "a pose graph", "load_pose_graph(path) returns one")
        mapper = cls(robot, seed=seed, max_range=max_range)
        mapper._begin(Nodes.from_graph(graph, robot), Pose2D(0.0, 0.0))
        return mapper

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], robot: Robot, *, seed: int = 0, max_range: float | None = None
    ) -> Mapper:
        """Continue the pose graph of a `.posegraph` file; see `from_graph`.

        Raises:
            InputError: If the file cannot be read, or is no pose graph of this version.
        """
        return cls.from_graph(load_pose_graph(path), robot, seed=seed, max_range=max_range)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write all that it knows to a `.posegraph` file, whole or not at all.

        Raises:
            OutputError: If the file cannot be written.
        """
        save_pose_graph(self.graph(), path)

    def reset(self, pose: Pose2D | None = None) -> None:
        """Forget everything, and start with the robot at a pose of the map frame; None for its origin."""
        self.revision += 1
        self._begin(Nodes(self.robot), Pose2D(0.0, 0.0) if pose is None else Pose2D.of(pose))

    def new_part(self) -> None:
        """Start a new part, as the robot was carried away; it is joined to the others when it recognises something."""
        if self._key is not None:
            self._picker.reset()
            self._begin_part()

    def relocate(self, pose: Pose2D, covariance: FloatArray | None = None) -> None:
        """Set the pose of the robot on the map. What was mapped stays, and what follows is drawn from there.

        What follows is a part that hangs together with the map by what was told, with its covariance of (x, y, yaw)
        [m², rad²] besides that of a hand on a map, until it recognises something: then it is moved to where that is.
        """
        if not len(self._nodes):
            self.reset(pose)
            return
        self._picker.reset()
        self._part -= self._key is None  # a part without a node is none
        self._begin_part(Pose2D.of(pose))
        self._is_apart = False
        self._told = self._off = _BY_HAND if covariance is None else _BY_HAND + check_covariance(covariance, "the pose")

    @property
    def anchor(self) -> tuple[int, Pose2D] | None:
        """A node, and the robot's pose seen from it: so a path can be corrected later. None before the first node."""
        if self._key is None or self._last is None:
            return None
        node, seen = self._key[0], self._key[1].inverse() @ self._local
        if self._floats is None:
            return node, seen
        return self._floats.stays, self._nodes.pose(self._floats.stays).inverse() @ self._nodes.pose(node) @ seen

    @property
    def joined(self) -> bool:
        """Whether the robot's part of the map hangs together with the first one."""
        if self._key is None:
            return self._part == 0
        roots = component_of(len(self._nodes), self._nodes.edges)
        return roots[self._key[0]] == roots[0]

    def update(self, observation: Observation) -> Estimate:
        """Map an observation, and return where the robot is.

        Raises:
            InputError: If the time is not after that of the last one.
        """
        check_kind(observation, Observation, "an observation", "a simulator's state has one")
        odometry = observation.odometry
        leapt = self._last is not None and self._last[0].distance_to(odometry) > _LEAP_M
        if (self._picker.follow(observation) or leapt) and self._key is not None:
            self._begin_part()
        if self._before is None:
            self._before = odometry, self._start
        known, local = self._before if self._last is None else self._last
        self._local = local @ (known.inverse() @ odometry)
        has_moved = self._last is None or _is_far(self._last[0].inverse() @ odometry, _LEAST_M, _LEAST_RAD)
        if observation.scans and has_moved:
            self._see(observation)
        return self._estimate(observation)

    def _see(self, observation: Observation) -> None:
        beams = self._picker.pick(observation)
        if beams is None:
            return
        if not len(beams):
            self._see_nothing(observation)
            return
        surface = make_surface(beams.points, beams.sensors)
        surface = self._moving.leave_out(surface, observation)
        odometry = observation.odometry
        if self._key is None or self._last is None:
            self._add_key(observation, surface, None)
            self._last = odometry, self._local
            return
        moved = self._last[0].inverse() @ odometry
        prior = motion_spread(moved)
        is_first = not len(self._window)  # the scans before met nothing, and there is nothing to match with
        match = Match(self._local, prior, 1.0, 1.0) if is_first else self._window.match(surface, self._local, prior)
        answer = self._carried.judge(observation, moved, match.fit, len(surface.points))
        if answer == "carried away":
            self._picker.warn(
                "carried",
                f"the scans at {observation.time:g} s show nothing that was seen before: "
                "the robot was carried away, or its odometry has failed; another part begins",
            )
            self._begin_part()
            self._before = odometry, self._start
        if answer != "here":
            return
        self._poor = self._poor + 1 if match.fit < _LOST_FIT else 0
        self._worst = min(self._worst, match.fit)
        self._local, self._spread = match.pose, match.covariance
        self._travel.to(odometry)
        self._last = odometry, match.pose
        since = self._key[1].inverse() @ match.pose
        if is_first or _is_far(since, _KEY_M, _KEY_RAD):
            self._add_key(observation, surface, match)
            return
        kept = since if self._kept is None else self._kept.inverse() @ since
        if self._floats is None and _is_far(kept, _KEPT_M, _KEPT_RAD):
            self._kept = since
            self._add_scans(observation, since)

    def _see_nothing(self, observation: Observation) -> None:
        """Map scans that met nothing: they saw free space, and the pose is that of the odometry alone."""
        if not any((scan.ranges >= min(scan.range_max, self._longest)).any() for scan in observation.scans):
            return
        if self._key is None or self._last is None:
            self._add_key(observation, _NOTHING, None)
            self._last = observation.odometry, self._local
            return
        since = self._key[1].inverse() @ self._local
        if _is_far(since, _KEY_M, _KEY_RAD):
            self._add_key(observation, _NOTHING, Match(self._local, motion_spread(since), 0.0, 0.0))

    def _add_key(self, observation: Observation, surface: Surface, match: Match | None) -> None:
        nodes, local = self._nodes, self._local
        pose, covariance = local, _EDGE_FLOOR
        self._travel.to(observation.odometry)
        if match is not None and self._key is not None:
            pose = nodes.pose(self._key[0]) @ (self._key[1].inverse() @ local)
            covariance = doubt_of(self._worst) * (turned(match.covariance, -self._key[1].yaw) + _EDGE_FLOOR)
        known = self._places.is_known(pose)
        if known and self._floats is not None and self._key is not None:
            covariance = covariance + self._floats.covariance
            before = self._floats.before
            self._loops.forget(self._key[0])
            self._submaps.remove_last()
            nodes.remove_last()
        else:
            before = self._key
            self.revision += before is None and len(nodes) > 0  # the map is that of another part from now on
        node = nodes.add_node(observation.time, self._part, pose, observation.odometry, self._travel.metres)
        if before is not None:
            nodes.add_edge(before[0], node, FOLLOWS, before[1].inverse() @ local, covariance)
        elif self._told is not None:
            near = nearest_joined(nodes, pose)
            T_near_node, yaw = nodes.pose(near).inverse() @ pose, nodes.pose(near).yaw
            nodes.add_edge(near, node, FOLLOWS, T_near_node, turned(self._told, -yaw))
            self._told = None
        self._floats = Floating(before, covariance, None) if known and before is not None else None
        self._key, self._kept, self._worst = (node, local), None, 1.0
        if self._floats is None:
            self._places.add(pose)
            self._add_scans(observation, Pose2D(0.0, 0.0))
        self._submaps.add(node)
        self._key_frames += 1
        if not len(surface.points):
            return
        self._window.add(surface, local)
        self._recent.add(local, surface)
        if self._key_frames % _LOOP_EVERY == 0:
            self._close_loops(node, surface)

    def _add_scans(self, observation: Observation, since: Pose2D) -> None:
        for scan in observation.scans:
            # Base_link at the first and at the last beam, seen from where it is now.
            first, last = self._picker.scan_poses(scan, observation) or (Pose2D(0.0, 0.0), Pose2D(0.0, 0.0))
            self._nodes.add_scan(scan, since @ first, since @ last)

    def _close_loops(self, node: int, surface: Surface) -> None:
        loops = self._loops.search(node, surface, self._recent.together())
        if loops:
            self._take(loops)

    def _take(self, loops: list[Loop]) -> None:
        """Add loops to the graph, and correct its poses; take them out again if they do not fit."""
        nodes = self._nodes
        if self._off.any() and any(contradicts(nodes, loop, self._part, self._off) for loop in loops):
            return  # the robot was told where it is: what looks like that elsewhere is another place
        first, before = len(nodes.edges), nodes.poses
        nodes.poses = join_parts(nodes, loops[-1])
        for loop in loops:
            nodes.add_edge(loop.a, loop.b, LOOP, loop.transform, loop.covariance)
        new = list(range(first, len(nodes.edges)))
        if self._late < _MOST_LATE and all(is_true(nodes, loop) for loop in loops):
            self._late += 1
            self._note(loops)
            self.revision += nodes.poses is not before
            return
        self._late = 0
        poses, errors = optimize(nodes, free=new)
        if not fits(errors[new]):
            del nodes.edges[first:], nodes.transforms[first:], nodes.covariances[first:]
            nodes.poses = before
            return
        self._note(loops)
        nodes.poses = list(poses)
        self.revision += 1

    def _note(self, loops: list[Loop]) -> None:
        for loop in loops:
            self._submaps.tie(loop.a, loop.b)
        self._is_apart = self._is_apart and not self.joined
        if any(self._nodes.parts[loop.a] != self._part for loop in loops):
            self._off = np.zeros((3, 3))
        if self._floats is not None:
            self._floats = replace(self._floats, anchor=loops[-1].a)

    def finish(self) -> None:
        """Look for loops once more, from all key frames, and correct all poses."""
        nodes = self._nodes
        if not len(nodes):
            return
        roots = component_of(len(nodes), nodes.edges)
        apart = next((node for node, root in enumerate(roots) if root != roots[0]), None)
        if apart is not None:
            self.seek_loops(apart)
        for loop in self._loops.search_again():
            nodes.add_edge(loop.a, loop.b, LOOP, loop.transform, loop.covariance)
            self._note([loop])
        nodes.poses = list(optimize(nodes, iterations=30)[0])
        self.revision += 1
        self._live = None  # small corrections are not drawn while the robot drives

    def seek_loops(self, first: int) -> None:
        """Look for loops from all key frames from a node on, as if the robot had just come there."""
        nodes, recent = self._nodes, self._recent
        self._recent = RecentSurfaces()
        for node in range(first, len(nodes)):
            if node > first and nodes.parts[node] != nodes.parts[node - 1]:
                self._recent.clear()
            surface = nodes.key_surface(node)
            if not len(surface.points):
                continue
            self._recent.add(nodes.pose(node), surface)
            if node % _LOOP_EVERY == 0:
                self._close_loops(node, surface)
        self._recent = recent

    def _estimate(self, observation: Observation) -> Estimate:
        if self._key is None:
            pose, covariance = self._local, self._spread
        else:
            node, local = self._key
            T_map_local = self._nodes.pose(node) @ local.inverse()
            pose, covariance = T_map_local @ self._local, turned(self._spread, T_map_local.yaw)
            if self._last is not None:
                covariance = covariance + motion_spread(self._last[0].inverse() @ observation.odometry) * 0.25
        T_map_odom = pose @ observation.odometry.inverse()
        is_lost = self._poor >= 10 or self._is_apart
        covariance = covariance + (np.diag(_LOST_VARIANCES) if is_lost else self._off)
        return Estimate(observation.time, pose, covariance, T_map_odom, "lost" if is_lost else "localized")

    def grid(self, *, resolution: float = 0.05) -> OccupancyGrid:
        """Return the map as far as it is known; only what is new or was corrected is drawn."""
        if self._live is None or self._live.resolution != resolution:
            self._live = LiveMap(resolution, self.robot)
        return self._live.draw(self._nodes, self._start)

    def graph(self) -> PoseGraph:
        """Return all that it knows."""
        return self._nodes.to_graph()

    def track(self) -> tuple[FloatArray, npt.NDArray[np.int32]]:
        """Return the poses of the nodes, and the loops among them; see `Nodes.track`."""
        return self._nodes.track()


def _is_far(motion: Pose2D, metres: float, radians: float) -> bool:
    return math.hypot(motion.x, motion.y) >= metres or abs(motion.yaw) >= radians

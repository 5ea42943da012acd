"""What is forgotten again: scans drawn from where the robot was not, key frames that the window has left."""

from __future__ import annotations

import numpy as np
import pytest

from mapping.rooms import ANGLES, cast, ring
from trundle import Pose2D, Robot, Scan
from trundle.mapping.drawing import LiveMap
from trundle.mapping.nodes import Nodes, make_surface
from trundle.mapping.window import ScanWindow

START = Pose2D(0.0, 0.0)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("nova_carter")


def graph_of(robot: Robot, poses: list[Pose2D]) -> Nodes:
    """Nodes in a chain, each with a scan of the rooms."""
    nodes = Nodes(robot)
    for i, pose in enumerate(poses):
        node = nodes.add_node(float(i), 0, pose, pose, float(i))
        scan = Scan("laser", float(i), Pose2D(0.0, 0.0), 0.3, ANGLES, cast(pose), 0.05, 30.0)
        nodes.add_scan(scan, Pose2D(0.0, 0.0), Pose2D(0.0, 0.0))
        if node:
            nodes.add_edge(node - 1, node, 0, poses[i - 1].inverse() @ pose, np.eye(3))
    return nodes


def test_a_correction_leaves_nothing_of_what_was_drawn_before(robot: Robot) -> None:
    nodes, live = graph_of(robot, [ring(share) for share in (0.0, 0.1, 0.2)]), LiveMap(0.05, robot)
    before = live.draw(nodes, START)
    nodes.poses[1] = nodes.poses[1] + (0.3, -0.2, 0.1)
    corrected, fresh = live.draw(nodes, START), LiveMap(0.05, robot).draw(nodes, START)
    assert corrected.origin == fresh.origin
    assert (corrected.data == fresh.data).all()
    assert before.shape != fresh.shape or (before.data != fresh.data).any()


def test_what_moves_by_less_than_a_cell_shows_is_not_drawn_again(robot: Robot) -> None:
    nodes, live = graph_of(robot, [ring(0.0), ring(0.1)]), LiveMap(0.05, robot)
    before = live.draw(nodes, START)
    nodes.poses[1] = nodes.poses[1] + (0.004, 0.0, 0.0)
    assert (live.draw(nodes, START).data == before.data).all()


def test_scans_of_a_node_are_added_once(robot: Robot) -> None:
    nodes, live = graph_of(robot, [ring(0.0), ring(0.1)]), LiveMap(0.05, robot)
    live.draw(nodes, START)
    scan = Scan("laser", 2.0, Pose2D(0.0, 0.0), 0.3, ANGLES, cast(ring(0.12)), 0.05, 30.0)
    moved = ring(0.1).inverse() @ ring(0.12)
    nodes.add_scan(scan, moved, moved)
    assert (live.draw(nodes, START).data == LiveMap(0.05, robot).draw(nodes, START).data).all()


def test_a_key_frame_leaves_the_window_after_forty_others() -> None:
    wall = np.column_stack((np.linspace(1.0, 3.0, 41), np.full(41, 1.0)))
    surface = make_surface(wall, np.zeros((41, 2)))
    window = ScanWindow()
    window.add(surface, Pose2D(-20.0, 0.0))
    for i in range(39):
        window.add(surface, Pose2D(10.0 + i, 0.0))
    spread = np.diag((0.01, 0.01, 0.001))
    assert len(window) == 40
    assert window.match(surface, Pose2D(-20.0, 0.0), spread).fit > 0.9
    window.add(surface, Pose2D(60.0, 0.0))
    assert len(window) == 40
    assert window.match(surface, Pose2D(-20.0, 0.0), spread).fit == 0.0

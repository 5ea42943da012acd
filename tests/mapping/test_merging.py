"""Merging pose graphs, and what their loops have changed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from support.pose_graphs import make_graph
from trundle.mapping import load_pose_graph, save_pose_graph
from trundle.mapping.merging import put_together
from trundle.mapping.parts import find_corrections, joined_nodes


def test_graphs_that_are_put_together_keep_all_of_both(tmp_path):
    first, second = make_graph(5), replace(make_graph(4), robot="")
    both = put_together(first, second)
    assert both.parts.tolist() == [0] * 5 + [1] * 4
    assert len(both.lidars) == 2
    np.testing.assert_array_equal(both.edges[5:, :2], second.edges[:, :2] + 5)
    np.testing.assert_array_equal(both.ranges[60:], second.ranges)
    assert joined_nodes(both).tolist() == [True] * 5 + [False] * 4
    save_pose_graph(both, tmp_path / "both.posegraph")  # every index is in bounds
    assert len(load_pose_graph(tmp_path / "both.posegraph").times) == 9


def test_lidars_of_another_mount_are_kept_apart():
    first = make_graph()
    second = replace(first, lidars=(replace(first.lidars[0], range_max=30.0), first.lidars[1]))
    both = put_together(first, second)
    assert [lidar.range_max for lidar in both.lidars] == [12.0, 12.0, 30.0]
    assert both.scan_lidars[10:].tolist() == [2, 1] * 5


def test_a_correction_is_how_far_the_chain_of_matches_was_off():
    graph = make_graph()
    transforms = graph.transforms.copy()
    steps = np.flatnonzero(graph.edges[:, 2] == 0)
    poses = np.column_stack([0.5 * np.arange(5), np.zeros(5), np.zeros(5)])
    transforms[steps] = (0.55, 0.0, 0.0)
    (one,) = find_corrections(replace(graph, poses=poses, transforms=transforms))
    assert (one.first, one.second) == (0, 4)
    assert one.metres == pytest.approx(0.2)
    assert one.radians == pytest.approx(0.0)


def test_a_loop_between_two_parts_joins_them():
    both = put_together(make_graph(3), make_graph(3))
    tied = replace(
        both,
        edges=np.vstack([both.edges, (1, 4, 1)]).astype(np.int32),
        transforms=np.vstack([both.transforms, (0.0, 0.0, 0.0)]),
        covariances=np.concatenate([both.covariances, both.covariances[:1]]),
    )
    assert joined_nodes(tied).all()
    first = find_corrections(tied)[0]
    assert (first.first, first.second, first.metres) == (1, 4, None)

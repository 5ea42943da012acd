import numpy as np

from trundle.evaluation.report.html.clusters import RADIUS, find_clusters


def test_failures_within_2_metres_are_one_cluster_wherever_they_lie():
    for shift in np.linspace(0.0, 2.0, 21):
        clusters = find_clusters(np.array([[0.9, 0.0], [1.1, 0.0], [0.9, 0.3], [9.0, 9.0]]) + shift)
        assert [len(cluster.members) for cluster in clusters] == [3, 1], shift


def test_every_failure_is_in_one_cluster_and_no_two_clusters_are_within_2_metres():
    points = np.random.default_rng(0).uniform(-20.0, 20.0, (500, 2))
    clusters = find_clusters(points)
    assert sorted(member for cluster in clusters for member in cluster.members) == list(range(500))
    centers = np.array([cluster.center for cluster in clusters])
    apart = np.hypot(*(centers[:, None] - centers[None]).T)
    # Squares of 0.5 m are merged by their own means, which a cluster's mean of points equals.
    assert apart[~np.eye(len(centers), dtype=bool)].min() > RADIUS - 1e-9


def test_the_largest_comes_first_and_its_first_member_is_nearest_to_its_centre():
    points = np.array([[0.0, 0.0], [10.0, 0.0], [10.6, 0.0], [10.2, 0.0]])
    first, second = find_clusters(points)
    assert first.members == (3, 1, 2)
    assert second.members == (0,)
    assert find_clusters(np.empty((0, 2))) == []


def test_ten_thousand_failures_all_over_a_map_are_clustered():
    points = np.random.default_rng(1).uniform(0.0, 60.0, (10_000, 2))
    clusters = find_clusters(points)
    assert sum(len(cluster.members) for cluster in clusters) == 10_000

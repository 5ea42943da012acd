"""`trundle map from-graph`: draw the map of a pose graph again: finer, moved, or with another one."""

from __future__ import annotations

from pathlib import Path

from cyclopts import App

from trundle.cli.map import drives

app = App(
    name="from-graph",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle map from-graph site.posegraph -o fine.yaml --resolution 0.025\n"
        "  trundle map from-graph site.posegraph -o site.yaml --origin 12.5,3,90deg\n"
        "  trundle map from-graph east.posegraph west.posegraph -o both.yaml"
    ),
)


@app.default
def from_graph(
    posegraph_file: Path,
    second: Path | None = None,
    /,
    *,
    of_map: drives.MapOptions = drives.MAP_DEFAULTS,
) -> int:
    """Draw the map of a pose graph again: with other cells, in another frame, or merged with a second pose graph.

    Two pose graphs are joined where their drives overlap, by the mapper's search for loops. The map frame is that of
    the first one. What is not recognised stays out of the map, and in the pose graph.

    Args:
        posegraph_file: A .posegraph file.
        second: Another one to merge into it.
    """
    from trundle.mapping import load_pose_graph, merge_pose_graphs
    from trundle.recordings.drive import make_unknown_robot

    machine = of_map.load_robot()
    targets = of_map.check(source=posegraph_file)
    graph = load_pose_graph(posegraph_file)
    facts: dict[str, object] = {"pose graph": posegraph_file}
    if second is not None:
        graph = merge_pose_graphs(graph, load_pose_graph(second), machine or make_unknown_robot(0.0, 0.0))
        facts["merged with"] = second
    return drives.write(graph, targets, of_map, robot=machine, facts=facts, remarks=[], is_new=second is not None)

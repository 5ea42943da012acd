"""`trundle plan`: one path on a map, and its picture."""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli import options, output, plan_compare, sources
from trundle.errors import NoPathError, UnknownNameError

app = App(
    name="plan",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle plan map.yaml --start -6,-1,3.14 --goal 5,3 -o overlay.png\n"
        "  trundle plan map.yaml --planner blog --seed 3 --json\n"
        "  trundle plan map.yaml --start -13,0 --goal 13,0 --compare"
    ),
)


@app.default
def plan(
    map_file: FilePath,
    /,
    *,
    start: options.Start = None,
    goal: options.Goal = None,
    robot: options.RobotName = "nova_carter",
    planner: options.PlannerName = "least_cost",
    compare: Annotated[bool, Parameter(negative="")] = False,
    seed: options.Seed = 0,
    compat: options.Compat = None,
    keepout: options.Keepout = None,
    speed_mask: options.SpeedMaskFile = None,
    backend: options.Backend = "mujoco",
    out: Annotated[FilePath, Parameter(name=["--out", "-o"])] = FilePath("overlay.png"),
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Plan a path on a map; print its length, cost and time, and draw it.

    The picture shows the map, its inflation, the zones of the masks, the path, and the robot's footprint at both ends.

    Args:
        map_file: The YAML of a ROS map.
        compare: Plan by every planner there is: a table of them, and all their paths in one picture. The times are
            medians of repeated plans on one map.
        backend: Taken as every step takes it; a plan needs no simulator, and none is started.
        out: The picture, or a folder for overlay.png.
    """
    from trundle.files import atomic_path
    from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
    from trundle.navigation import Navigator
    from trundle.planning import planner_names
    from trundle.record.overlay import draw_plan
    from trundle.sim import simulator_names

    if backend not in simulator_names():
        raise UnknownNameError("backend", backend, simulator_names())
    first = options.parse_pose("--start", start) if start else None
    last = options.parse_goal("--goal", goal) if goal else None
    target = options.output_file(out, "overlay.png", (".png",))
    navigator = Navigator(
        OccupancyGrid.load(map_file, compat=compat),
        robot,
        planner=planner,
        keepout=None if keepout is None else KeepoutMask.load(keepout, compat=compat),
        speed_mask=None if speed_mask is None else SpeedMask.load(speed_mask, compat=compat),
    )
    begin, end = sources.pick_ends(navigator.costmap, first, last, seed=seed)
    if compare:
        return plan_compare.compare(navigator, begin, end, planner_names(), target=target, json=json)
    navigator.set_goal(end)
    try:
        path = navigator.plan(begin)
    except NoPathError as error:
        output.remark(f"trundle: {error}", quiet=False)
        return 1
    picture = draw_plan(navigator.costmap, path, navigator.robot, speed_mask=navigator.speed_mask)
    with atomic_path(target) as temporary:
        picture.save(temporary, format="PNG")
    facts = {
        "length_m": path.length,
        "cost": path.cost,
        "planning_ms": 1000.0 * navigator.planning_time_s,
        "planner": planner,
        "replans": path.replans,
        "start_snapped_m": path.start_snapped_m,
        "goal_snapped_m": path.goal_snapped_m,
        "overlay": target,
    }
    if json:
        output.print_json({**facts, "map": map_file, "robot": navigator.robot.name, "poses": path.poses})
        return 0
    output.print_facts(
        {
            "from": "x {:.3f}, y {:.3f}, yaw {:.3f}".format(*path.start.as_tuple()),
            "to": "x {:.3f}, y {:.3f}, yaw {:.3f}".format(*path.goal.as_tuple()),
            "length": f"{path.length:.3f} m",
            "cost": path.cost,
            "time": f"{facts['planning_ms']:.1f} ms",
            "planner": f"{planner}, planned again {path.replans} times",
            "overlay": target,
        }
    )
    return 0

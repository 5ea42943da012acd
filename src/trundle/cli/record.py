"""`trundle record`: look into recordings, complete them, and make runs of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import options, output
from trundle.messages.codec import DEFAULT

app = App(
    name="record",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle run warehouse --lidar --record\n"
        "  trundle record info runs/demo/run.mcap\n"
        "  trundle record recover runs/demo/run.partial.mcap\n"
        "  trundle record to-run rosbag2_2026_05_04-10_31_07 --robot my_robot.yaml -o runs/field"
    ),
)


@app.command(name="info")
def info(file: Path, /, *, distro: options.Distro = None, json: options.Json = False) -> int:
    """List the contents of a bag, even if its writer was killed.

    Args:
        file: A .mcap or .db3 file, or the folder of a rosbag2.
    """
    from trundle.bags import read_info

    found = read_info(file, distro=distro or DEFAULT)
    facts = found.as_dict()
    if json:
        output.print_json(facts)
        return 0
    seconds = found.end_s - found.begin_s
    output.print_facts(
        {
            "file": found.path,
            "size": f"{found.size_bytes / 1e6:.2f} MB",
            "time": f"{seconds:.2f} s, from {found.begin_s:.2f} to {found.end_s:.2f} s",
            "messages": found.messages,
            "complete": "yes" if found.damage is None else f"no: {found.damage}",
            **{name: value for name in ("run", "outcome", "distro") if (value := facts[name]) is not None},
        }
    )
    print()
    output.print_table(
        ("topic", "type", "messages", "per second"),
        [
            (topic.name, topic.type_name, topic.count, f"{topic.count / seconds:.1f}" if seconds > 0.0 else None)
            for topic in found.topics
        ],
    )
    if found.damage is not None:
        output.remark(f"trundle record recover {file} makes a complete file of it", quiet=False)
    return 0


@app.command(name="recover")
def recover(
    file: Path,
    /,
    *,
    out: options.Out = None,
    overwrite: options.OverwriteFile = False,
    json: options.Json = False,
) -> int:
    """Complete a recording whose writer was killed, as a new file; the source is kept.

    Args:
        file: The MCAP file, such as run.partial.mcap.
        out: The new file; default: run.mcap for run.partial.mcap, and name.recovered.mcap for others.
    """
    from trundle.bags import recover as recover_file

    done = recover_file(file, out, overwrite=overwrite)
    facts = {
        "file": done.path,
        "messages": done.messages,
        "duration_s": done.duration_s,
        "end_s": done.end_s,
        "damage": done.damage,
    }
    if json:
        output.print_json(facts)
    else:
        output.print_facts({**facts, "damage": done.damage or "none: it was complete"})
    return 0


@app.command(name="to-run")
def to_run(
    file: Path,
    /,
    *,
    robot: Annotated[str | None, Parameter(name="--robot", help=options.ROBOT_HELP)] = None,
    map_: Annotated[str | None, Parameter(name="--map", metavar="TOPIC|FILE")] = None,
    odom: Annotated[str | None, Parameter(name="--odom", metavar="TOPIC")] = None,
    plan: Annotated[str | None, Parameter(name="--plan", metavar="TOPIC")] = None,
    distro: options.Distro = None,
    video: bool = False,
    out: options.Out = None,
    overwrite: options.Overwrite = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Turn a bag into a run folder: a bag of trundle's, or of any robot with /tf, /odom, /map and /plan.

    Topics and frames are found by their types where they have other names. The folder has the files of a run, with the
    map as map.yaml.

    Args:
        file: A .mcap or .db3 file, or the folder of a rosbag2.
        map_: Topic of the map, or the YAML file of a ROS map for a bag without one.
        odom: Topic of the odometry.
        plan: Topic of the plans.
        video: Write video.mp4 too.
        out: Output folder, which must not hold a run; default: a new one under runs.
    """
    from trundle.bags import read_run
    from trundle.bags.bag_content import TopicNames
    from trundle.cli.shared.missions import report
    from trundle.record.folder_claim import check_free
    from trundle.record.progress import ProgressBar
    from trundle.record.run_folder import RunFolder

    check_free(out, overwrite=overwrite, extra=_EXTRAS)
    found = read_run(file, robot=robot, names=TopicNames(map_, odom, plan), distro=distro or DEFAULT)
    for remark in found.remarks:
        output.remark(f"trundle: {remark}", quiet=quiet)
    with (
        ProgressBar(quiet=quiet) as bar,
        RunFolder(
            out,
            name=found.info.name,
            overwrite=overwrite,
            scenario=found.scenario,
            video=video,
            report=bar.report,
            extras={_EXTRAS[0]: lambda path, _: found.grid.save(path)},
        ) as folder,
    ):
        found.play([folder])
    report(found.episode, folder, json=json)
    return 0


_EXTRAS = ("map.yaml",)

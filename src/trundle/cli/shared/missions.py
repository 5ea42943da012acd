"""Driving a scenario and reporting the result, shared by `trundle run` and `trundle demo`."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from trundle.cli.shared import isaac, output
from trundle.cli.shared.recordings import FolderRecording
from trundle.values import first_names

if TYPE_CHECKING:
    from trundle.mission import Episode, Metrics, Mission, Observer, RunInfo, Scenario
    from trundle.record.run_folder import RunFolder, WriteExtra
    from trundle.record.video import MakeFrames
    from trundle.viewer.scene_frames import SceneFrames


def drive(
    scenario: Scenario,
    *,
    out: Path | None,
    overwrite: bool,
    video: bool,
    view: bool,
    json: bool,
    quiet: bool,
    with_place: bool = False,
    narrate: bool = False,
    page: bool = True,
) -> int:
    """Run a scenario once, record it, and print the result.

    Args:
        scenario: The scenario.
        out: Output folder; None means a new one under runs.
        overwrite: Replace an existing run in it.
        video: Whether to make a video.
        view: Whether to show it in a window while it drives.
        json: Print one JSON value.
        quiet: No progress bar and no remarks.
        with_place: Whether to add the map and a picture of the scene to the folder.
        narrate: Whether to print each stage, and the progress if there is no terminal for a progress bar.
        page: Whether to write report.html.

    Returns:
        The exit code: 0 if the robot arrived, else 1.
    """
    from trundle.record.folder_claim import check_free
    from trundle.record.progress import ProgressBar
    from trundle.record.run_folder import RunFolder, with_images
    from trundle.sim.mujoco.engine import import_engine

    place = (_MAP, _SCENE) if with_place else ()
    check_free(out, overwrite=overwrite, extra=with_images(place))
    isaac.check_window(view, scenario.backend.name)
    if scenario.backend.name == "mujoco":
        import_engine()
    recording = FolderRecording(scenario.record, out, overwrite=overwrite)
    # The report comes before the simulator is closed: closing Isaac Sim may end the process.
    with ExitStack() as opened:
        opened.enter_context(isaac.start_for(scenario))
        if narrate:
            output.remark("Building the world, its map and the simulation", quiet=quiet)
        mission = opened.enter_context(scenario.build())
        with ExitStack() as stack:
            observers: list[Observer] = []
            if view:
                from trundle.viewer.watcher import Watcher, open_window

                observers.append(Watcher(stack.enter_context(open_window(mission.world, mission.robot, mission.start))))
            bar = stack.enter_context(ProgressBar(quiet=quiet, plain=narrate))
            frames = None
            if video:
                _remark_on_encoder(scenario, quiet=quiet)
                frames = _scene_frames(mission, quiet=quiet)
            folder = stack.enter_context(
                RunFolder(
                    out,
                    name=scenario.title,
                    overwrite=overwrite,
                    scenario=mission.scenario,
                    page=page,
                    video=video,
                    frames=frames,
                    report=bar.report,
                    extras={**{name: _PLACE[name](mission) for name in place}, **recording.files},
                )
            )
            observers += stack.enter_context(recording).start(folder.path, mission.scenario)
            if narrate:
                recorded = "record, report, pictures and video" if video else "record, report and pictures"
                output.remark(f"Planning and driving, then writing {recorded}", quiet=quiet)
            episode = mission.run(observers=[*observers, bar, folder])
        report(episode, folder, json=json)
    for error in episode.observer_errors:
        raise error
    return 0 if episode.arrived else 1


def _remark_on_encoder(scenario: Scenario, *, quiet: bool) -> None:
    """Print how to enable MP4 videos if PyAV is missing."""
    from trundle.record.video import has_encoder

    if has_encoder():
        return
    # trundle's own extra would also install MuJoCo, which prevents Isaac Sim from starting.
    in_isaac = scenario.backend.name == isaac.BACKEND
    install = "python.sh -m pip install --no-deps av" if in_isaac else 'pip install "trundle[video]"'
    output.remark(f"The video will be a GIF, because PyAV is not installed. For an MP4: {install}", quiet=quiet)


def _scene_frames(mission: Mission, *, quiet: bool) -> MakeFrames | None:
    """Frames rendered with OpenGL; None for a video drawn from above: in Isaac Sim, or without a driver."""
    if mission.scenario.backend.name == isaac.BACKEND:
        return None
    from trundle.viewer.gl import describe_missing_gl, find_gl

    if find_gl() is None:
        output.remark(f"The video is drawn from above. {describe_missing_gl()}", quiet=quiet)
        return None

    def make(_run: RunInfo, episode: Episode) -> SceneFrames:
        from trundle.viewer.scene_frames import SceneFrames

        return SceneFrames(mission, episode)

    return make


def _write_map(mission: Mission) -> WriteExtra:
    return lambda path, _: mission.grid.save(path)


def _write_scene(mission: Mission) -> WriteExtra:
    def write(path: Path, episode: Episode) -> None:
        from trundle.viewer.offscreen import render

        picture = render(
            mission.world,
            mission.robot,
            mission.start,
            camera="overview",
            path=episode.paths[0].poses if episode.paths else None,
            goal=mission.goals[-1].pose,
        )
        picture.save(path)

    return write


_MAP, _SCENE = "map.yaml", "scene.png"
_PLACE = {_MAP: _write_map, _SCENE: _write_scene}
"""Writers of the map and the picture of the scene."""


def _sensing_facts(metrics: Metrics) -> dict[str, str]:
    """What a run with a localizer, moving obstacles, a collision monitor or standstills adds to the report."""
    facts: dict[str, str] = {}
    if metrics.standing_contacts:
        facts["run into while standing"] = first_names(metrics.standing_contacts)
    if metrics.unseen_contacts:
        facts["touched, but out of the lidars' sight"] = first_names(metrics.unseen_contacts)
    if metrics.position_error_m > 0.0:
        facts["error of the estimate"] = f"{metrics.position_error_m:.3f} m"
    if metrics.monitor_stops is not None:
        facts["collision monitor"] = f"stopped it {metrics.monitor_stops} times"
    if metrics.standing_reasons:
        reasons = (f"{reason} {periods}" for reason, periods in metrics.standing_reasons.items())
        facts["periods without progress"] = ", ".join(reasons)
    return facts


def _behavior_facts(episode: Episode) -> dict[str, str]:
    """What a run with recovery or other behaviors adds to the report."""
    from trundle.navigation.behaviors import describe_behaviors

    recovery = describe_behaviors([ran for ran in episode.behaviors if ran.recovery])
    others = describe_behaviors([ran for ran in episode.behaviors if not ran.recovery])
    return {name: text for name, text in (("recovery", recovery), ("behaviors", others)) if text}


def report(episode: Episode, folder: RunFolder, *, json: bool) -> None:
    """Print how a run ended, its figures and its folder."""
    if json:
        output.print_json(folder.record or {**episode.as_dict(), "run_dir": folder.path})
        return
    metrics = episode.metrics
    output.print_facts(
        {
            "outcome": episode.outcome.value if episode.arrived else f"{episode.outcome.value}: {episode.message}",
            "time": f"{metrics.time_s:.1f} s",
            "distance": f"{metrics.distance_m:.2f} m (planned {metrics.path_length_m:.2f} m)",
            "smallest clearance": "unknown" if metrics.min_clearance_m is None else f"{metrics.min_clearance_m:.3f} m",
            "planning time": f"{metrics.planning_ms:.1f} ms",
            "real-time factor": f"{metrics.real_time_factor:.0f}",
            "contacts": first_names(metrics.contacts) or "none",
            **_sensing_facts(metrics),
            **_behavior_facts(episode),
            "folder": folder.path,
        }
    )

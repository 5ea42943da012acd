"""Driving a scenario and reporting the result, shared by `trundle run` and `trundle demo`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from cyclopts import Parameter

from trundle.cli.shared import browser, isaac, options, output
from trundle.cli.shared.recordings import FolderRecording
from trundle.cli.shared.recordings import choose as choose_recording
from trundle.extras import install_line
from trundle.fault import is_of_plugin
from trundle.values import first_names

if TYPE_CHECKING:
    from trundle.mission import Episode, Metrics, Mission, Observer, RunInfo, Scenario
    from trundle.record.run_folder import RunFolder, WriteExtra
    from trundle.record.video import MakeFrames
    from trundle.viewer.scene import SceneFrames


Finish: TypeAlias = "Callable[[Mission, Episode, RunFolder], int]"
"""Reports how a mission ended, and returns the exit code."""


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class PresentationOptions:
    """Options of how a run is shown while it drives, and of what is recorded of it.

    Attributes:
        report: Write report.html: one file with the replay, plots and figures of the run.
        video: Write video.mp4.
        view: Watch it drive in a window, if there is a screen.
        out: Output folder, which must not hold a run; default: a new one under runs.
    """

    report: bool = True
    video: bool = True
    view: options.Flag = False
    browser: options.Browser = False
    speed: options.RunSpeed = None
    record: options.Record = False
    distro: options.Distro = None
    out: options.Out = None
    overwrite: options.Overwrite = False
    json: options.Json = False
    quiet: options.Quiet = False

    @property
    def factor(self) -> float | None:
        """Simulated seconds per second; infinity is as fast as possible. None is 1 where the run is shown."""
        return None if self.speed is None else options.parse_speed(self.speed)


def drive(
    scenario: Scenario,
    shown: PresentationOptions,
    *,
    with_place: bool = False,
    narrate: bool = False,
    facts: Mapping[str, object] | None = None,
    finish: Finish | None = None,
) -> int:
    """Run a scenario once, record it, and print the result.

    In the browser it can be restarted; the last run counts, and the command ends when the page is closed.

    Args:
        scenario: The scenario.
        shown: How it is shown, and what is recorded.
        with_place: Whether to add the map and a picture of the scene to the folder.
        narrate: Whether to print each stage, and the progress if there is no terminal for a progress bar.
        facts: Further members of the JSON value.
        finish: Reports the result of the last run, and returns the exit code; by default it is `report`.

    Returns:
        The exit code: 0 if the robot arrived, else 1.

    Raises:
        BaseException: What a plug-in raised; the run has a folder then, too.
    """
    from trundle.record.folder_claim import check_free
    from trundle.record.run_folder import with_images
    from trundle.sim.mujoco.engine import import_engine

    scenario = choose_recording(scenario, record=shown.record, distro=shown.distro)
    speed = shown.factor
    place = tuple(_PLACE) if with_place else ()
    check_free(shown.out, overwrite=shown.overwrite, extra=with_images(place))
    isaac.check_window(shown.view, scenario.backend.name)
    if scenario.backend.name == "mujoco":
        import_engine()
    recorder = _Recorder(scenario, shown, place, narrate=narrate)
    try:
        # The report comes before the simulator is closed: closing Isaac Sim may end the process.
        with ExitStack() as opened:
            opened.enter_context(isaac.start_for(scenario))
            if shown.browser:
                episode = _drive_in_browser(scenario, shown, 1.0 if speed is None else speed, recorder, opened)
            else:
                recorder.narrate("Building the world, its map and the simulation")
                mission = opened.enter_context(scenario.build())
                with ExitStack() as stack:
                    observers, _ = recorder(mission, stack)
                    episode = _run(mission, observers, speed)
            code = recorder.report(episode, facts, finish)
    except BaseException as error:
        if not shown.browser and is_of_plugin(error) and not recorder.has_record:
            recorder.record_failure(error, scenario)
        raise
    for error in episode.observer_errors:
        raise error
    return code


def _run(mission: Mission, observers: Sequence[Observer], speed: float | None) -> Episode:
    """Run it as fast as it can, or at the wanted speed."""
    if speed is None:
        return mission.run(observers=observers)
    from trundle.mission import LiveRun, Steering

    steering = Steering()
    return LiveRun(lambda _: mission.session(observers=observers, steering=steering), steering, speed=speed).run()


def _drive_in_browser(
    scenario: Scenario, shown: PresentationOptions, speed: float, recorder: _Recorder, opened: ExitStack
) -> Episode:
    """Show it in the browser, until it has ended and the page is closed."""
    from trundle.serve.run_service import RunService

    page = opened.enter_context(browser.serving(scenario, source=scenario.title))
    browser.announce(page, quiet=shown.quiet)
    recorder.narrate("Building the world, its map and the simulation")
    service = opened.enter_context(RunService(page.hub, scenario, recorder, recorder.record_failure, speed=speed))
    try:
        service.drive(scenario)
    except BaseException as error:
        if not is_of_plugin(error):
            raise
        service.tell(error)
    browser.linger(page, lambda is_over: service.serve(until=is_over), quiet=shown.quiet)
    return service.last_episode()


class _Recorder:
    """Opens what records and shows a run, and prints its result."""

    def __init__(
        self, scenario: Scenario, shown: PresentationOptions, place: tuple[str, ...], *, narrate: bool
    ) -> None:
        self._scenario, self._shown = scenario, shown
        self._place, self._narrate = place, narrate
        self._out = shown.out
        self._folder: RunFolder | None = None
        self._mission: Mission | None = None
        self._recording: FolderRecording | None = self._new_recording()

    def __call__(self, mission: Mission, opened: ExitStack) -> tuple[list[Observer], Path | None]:
        """Open it; the folder of --out is for the first run, those after a restart get new ones."""
        from trundle.record.progress import ProgressBar
        from trundle.record.run_folder import RunFolder

        shown, self._mission = self._shown, mission
        observers: list[Observer] = []
        if shown.view:
            from trundle.viewer.native import Watcher, open_window

            window = opened.enter_context(open_window(mission.world, mission.robot, mission.start))
            observers.append(Watcher(window, paces=shown.speed is None and not shown.browser))
        bar = opened.enter_context(ProgressBar(quiet=shown.quiet, plain=self._narrate))
        recording = self._recording or self._new_recording()
        self._recording = None
        frames = None
        if shown.video:
            _remark_on_encoder(self._scenario, quiet=shown.quiet)
            frames = _scene_frames(mission, quiet=shown.quiet)
        folder = opened.enter_context(
            RunFolder(
                self._out,
                name=self._scenario.title,
                overwrite=shown.overwrite,
                scenario=mission.scenario,
                page=shown.report,
                video=shown.video,
                frames=frames,
                report=bar.report,
                extras={**{name: _PLACE[name](mission) for name in self._place}, **recording.files},
            )
        )
        observers += opened.enter_context(recording).start(folder.path, mission.scenario)
        self._out, self._folder = None, folder
        recorded = "record, report, pictures and video" if shown.video else "record, report and pictures"
        self.narrate(f"Planning and driving, then writing {recorded}")
        return [*observers, bar, folder], folder.path

    def _new_recording(self) -> FolderRecording:
        return FolderRecording(self._scenario.record, self._out, overwrite=self._shown.overwrite)

    @property
    def has_record(self) -> bool:
        """Whether the last run has written its folder."""
        return self._folder is not None and self._folder.record is not None

    def record_failure(self, error: BaseException, scenario: Scenario) -> None:
        """Write the folder of a run in which a plug-in raised before it began, where its own was to be."""
        from trundle.record.run_folder import record_failure

        folder = self._folder
        out = self._out if folder is None or folder.record is not None else folder.path
        self._out = self._folder = None
        record_failure(error, scenario, out, overwrite=self._shown.overwrite, page=self._shown.report)

    def narrate(self, stage: str) -> None:
        """Print a stage, if that is wanted."""
        if self._narrate:
            output.remark(stage, quiet=self._shown.quiet)

    def report(self, episode: Episode, facts: Mapping[str, object] | None, finish: Finish | None) -> int:
        """Print the result of the last run, as JSON with more facts; return the exit code."""
        if self._folder is not None and self._mission is not None:
            if finish is not None:
                return finish(self._mission, episode, self._folder)
            report(episode, self._folder, json=self._shown.json, facts=facts)
        return 0 if episode.arrived else 1


def _remark_on_encoder(scenario: Scenario, *, quiet: bool) -> None:
    """Print how to enable MP4 videos if PyAV is missing."""
    from trundle.record.video import has_encoder

    if has_encoder():
        return
    # trundle's own extra would also install MuJoCo, which prevents Isaac Sim from starting.
    in_isaac = scenario.backend.name == isaac.BACKEND
    install = "python.sh -m pip install --no-deps av" if in_isaac else install_line("video")
    output.remark(f"The video will be a GIF, because PyAV is not installed. For an MP4: {install}", quiet=quiet)


def _scene_frames(mission: Mission, *, quiet: bool) -> MakeFrames | None:
    """Return what renders frames with OpenGL. In Isaac Sim or without a driver return None: it is drawn from above."""
    if mission.scenario.backend.name == isaac.BACKEND:
        return None
    from trundle.viewer.gl import describe_missing_gl, find_gl

    if find_gl() is None:
        output.remark(f"The video is drawn from above. {describe_missing_gl()}", quiet=quiet)
        return None

    def make(_run: RunInfo, episode: Episode) -> SceneFrames:
        from trundle.record.video import pick_rows
        from trundle.viewer.scene import SceneFrames

        return SceneFrames(mission, episode, pick_rows(len(episode.trajectory)))

    return make


def _write_map(mission: Mission) -> WriteExtra:
    return lambda path, _: mission.grid.save(path)


def _write_scene(mission: Mission) -> WriteExtra:
    def write(path: Path, episode: Episode) -> None:
        from trundle.viewer.scene import render

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
"""Files of the place, the map and a picture of the scene, and what writes them."""


def _sensing_facts(metrics: Metrics) -> dict[str, str]:
    """Return what the report adds on a localizer, moving obstacles, a collision monitor and standstills."""
    facts: dict[str, str] = {}
    if metrics.standing_contacts:
        facts["run into while standing"] = first_names(metrics.standing_contacts)
    if metrics.unseen_contacts:
        facts["touched, but out of the lidars' sight"] = first_names(metrics.unseen_contacts)
    if metrics.position_error_m > 0.0:
        facts["error of the estimate"] = (
            f"{metrics.position_error_m:.3f} m at the end, {metrics.localization_error_m:.3f} m on average, below "
            f"{metrics.localization_error_p95_m:.3f} m for 95 % of the run"
        )
    if metrics.lost_s > 0.0:
        facts["not localized"] = f"{metrics.lost_s:.1f} s"
    if metrics.monitor_stops is not None:
        facts["collision monitor"] = f"stopped it {metrics.monitor_stops} times"
    if metrics.standing_reasons:
        reasons = (f"{reason} {periods}" for reason, periods in metrics.standing_reasons.items())
        facts["periods without progress"] = ", ".join(reasons)
    return facts


def _behavior_facts(episode: Episode) -> dict[str, str]:
    """Return what the report adds on recovery and other behaviors."""
    from trundle.navigation.behaviors import describe_behaviors

    recovery = describe_behaviors([ran for ran in episode.behaviors if ran.recovery])
    others = describe_behaviors([ran for ran in episode.behaviors if not ran.recovery])
    return {name: text for name, text in (("recovery", recovery), ("behaviors", others)) if text}


def map_facts(episode: Episode) -> dict[str, str]:
    """Return what the report adds on the map that the robot has made."""
    from trundle.mission.own_map import describe_corrections

    own = episode.own_map
    if own is None:
        return {}
    rows, cols = own.grid.shape
    edge = own.grid.resolution
    return {
        "own map": f"{cols * edge:.1f} x {rows * edge:.1f} m",
        "largest corrections": describe_corrections(own.corrections),
    }


def report(episode: Episode, folder: RunFolder, *, json: bool, facts: Mapping[str, object] | None = None) -> None:
    """Print how a run ended, its figures and its folder; as JSON with more facts."""
    if json:
        output.print_json({**(folder.record or {**episode.as_dict(), "run_dir": folder.path}), **(facts or {})})
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
            **map_facts(episode),
            "folder": folder.path,
        }
    )

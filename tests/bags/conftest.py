from dataclasses import dataclass
from pathlib import Path

import pytest

from trundle.bags import Recorder
from trundle.maps import OccupancyGrid
from trundle.mission import Episode, RunInfo, Scenario, Step


class Keep:
    """An observer that keeps what it gets."""

    def __init__(self) -> None:
        self.steps: list[Step] = []

    def on_start(self, run: RunInfo) -> None:
        self.info = run

    def on_step(self, step: Step) -> None:
        self.steps.append(step)

    def on_end(self, episode: Episode) -> None:
        self.episode = episode


@dataclass(frozen=True)
class Recorded:
    """A run of some seconds with two lidars, and its recording."""

    path: Path
    info: RunInfo
    steps: list[Step]
    episode: Episode
    scenario: Scenario
    grid: OccupancyGrid


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    path = tmp_path_factory.mktemp("recorded") / "run.mcap"
    scenario = Scenario.make(world="warehouse", seed=4, backend="kinematic", lidar=True, time_limit_s=6.0)
    keep = Keep()
    with scenario.build() as mission:
        episode = mission.run(observers=[keep, Recorder(path, scenario=mission.scenario)])
        assert not episode.observer_errors
        return Recorded(path, keep.info, keep.steps, episode, mission.scenario, mission.grid)


@pytest.fixture
def partial(recorded: Recorded, tmp_path: Path) -> Path:
    """The file of a recorder that was closed before the end of its run."""
    with Recorder(tmp_path / "run.mcap", scenario=recorded.scenario) as recorder:
        recorder.on_start(recorded.info)
        for step in recorded.steps:
            recorder.on_step(step)
    return tmp_path / "run.partial.mcap"

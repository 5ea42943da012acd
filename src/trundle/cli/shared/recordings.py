"""Recording a run or a drive besides its folder's other files, shared by the verbs that have `--record`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self

from trundle.errors import InputError
from trundle.extras import check_extra

if TYPE_CHECKING:
    from trundle.bags import Recorder
    from trundle.messages.codec import Distro
    from trundle.mission import Observer, Scenario
    from trundle.mission.fields import RecordChoice
    from trundle.record.run_folder import WriteExtra

FILE = "run.mcap"


def choose(scenario: Scenario, *, record: bool, distro: Distro | None) -> Scenario:
    """Return the scenario with what `--record` and `--distro` say.

    Raises:
        InputError: If a distribution is given for a run that is not recorded.
    """
    chosen = choose_record(scenario.record, record=record, distro=distro)
    return scenario if chosen is None else scenario.model_copy(update={"record": chosen})


def choose_record(kept: RecordChoice | None, *, record: bool, distro: Distro | None) -> RecordChoice | None:
    """Return what is recorded by a scenario and the options; see `choose`."""
    from trundle.mission.fields import RecordChoice

    if not record and kept is None:
        if distro is not None:
            raise InputError(f"--distro {distro} is for a recording: give --record with it")
        return None
    return RecordChoice(distro=distro or (None if kept is None else kept.distro))


class FolderRecording:
    """Writes the recording in a run's folder, if one is wanted. Use it in a `with` block.

    Args:
        choice: What is recorded. If None, nothing is.
        out: The folder. If None, it is a new one.
        overwrite: Replace what the folder has.

    Raises:
        MissingExtraError: If the libraries of recordings are not installed.
        OutputError: If the folder has a recording, perhaps one that a killed run left.
    """

    def __init__(self, choice: RecordChoice | None, out: Path | None, *, overwrite: bool) -> None:
        self._choice = choice
        self._recorder: Recorder | None = None
        if choice is None:
            return
        check_extra("record", "--record")
        from trundle.bags.recorder import check_free

        if out is not None and not overwrite:
            check_free(out / FILE)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._recorder is not None:
            self._recorder.close()

    @property
    def files(self) -> Mapping[str, WriteExtra]:
        """What writes the recording, by file name, for `RunFolder(extras=…)`."""
        return {} if self._choice is None else {FILE: lambda path, _: self.save(path)}

    def start(self, folder: Path, scenario: Scenario | None = None) -> list[Observer]:
        """Return the observers that record a run into a folder that was claimed."""
        if self._choice is None:
            return []
        from trundle.bags import Recorder
        from trundle.messages.codec import DEFAULT

        distro = self._choice.distro or DEFAULT
        self._recorder = Recorder(folder / FILE, scenario=scenario, distro=distro, overwrite=True, named_by_folder=True)
        return [self._recorder]

    def save(self, path: Path) -> None:
        """Rename the finished recording to its final name."""
        if self._recorder is not None:
            self._recorder.save(path)

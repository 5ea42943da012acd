"""The files of an evaluation's folder, and which folders are refused."""

from __future__ import annotations

from pathlib import Path

from trundle.errors import InputError, OutputError
from trundle.files.kinds import DRIVE, RUN, find_kind
from trundle.files.opening import exists

SUITE = "suite.yaml"
MANIFEST = "evaluation.json"
JOURNAL = "journal.jsonl"
DAMAGED_LINES = f"{JOURNAL}.damaged"
"""Lines of the journal that held no row when the evaluation was continued."""
PARTS = "parts"
SELECTION = "selection.npy"
"""The ids of the suite's episodes, by index: written where the folder also holds rows that are not of the suite."""

WRITTEN_AFTERWARDS = ("report.html", "junit.xml", "summary.json")

HOLDS_RUN = (RUN, DRIVE)


def check_free_for_evaluation(folder: Path) -> None:
    """Refuse a folder without an evaluation that holds something of which a file would be replaced.

    Raises:
        OutputError: If it holds a run, or a file of the name of one that is written.
    """
    kind = find_kind(folder)
    if kind in HOLDS_RUN:
        raise OutputError(f"{folder} is {kind}, not of an evaluation; give another folder with -o")
    held = [name for name in (SUITE, JOURNAL, PARTS, *WRITTEN_AFTERWARDS) if exists(folder / name)]
    if held:
        raise OutputError(
            f"{folder} holds no evaluation, but files that one would replace ({', '.join(held)}); give another folder "
            "with -o"
        )


def check_holds_evaluation(folder: Path) -> None:
    """Refuse a folder that is not an evaluation's.

    Raises:
        InputError: If it is not; for a run's folder, the message names the verbs for those.
    """
    if exists(folder / MANIFEST):
        return
    if not exists(folder):
        raise InputError(f"{folder}: no such folder; give the folder that trundle evaluate wrote")
    if not folder.is_dir():
        raise InputError(f"{folder}: not a folder; give the folder that trundle evaluate wrote")
    kind = find_kind(folder)
    if kind in HOLDS_RUN:
        raise InputError(
            f"{folder}: this is {kind}, not of an evaluation: trundle compare compares runs and drives, and trundle "
            "run --from runs one again"
        )
    raise InputError(f"{folder}: no {MANIFEST} in it; give the folder that trundle evaluate wrote")

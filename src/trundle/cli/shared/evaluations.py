"""Episodes of an evaluation as command-line arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.cli.shared.given import check_given
from trundle.errors import InputError
from trundle.files.kinds import EVALUATION

if TYPE_CHECKING:
    from trundle.mission import Scenario


def find_scenario(text: str, map: str | None = None) -> Scenario:
    """The exact scenario of `FOLDER:ID`, whose map is `map` where that is given.

    Raises:
        InputError: If the folder has no evaluation, or there is no such episode, or more than one.
    """
    folder, colon, identity = text.rpartition(":")
    if not colon or not folder or not identity:
        raise InputError(f"--from {text}: give the folder of an evaluation and the start of an episode's id, FOLDER:ID")
    check_given(folder, EVALUATION)
    from trundle.evaluation import Evaluation

    return Evaluation(folder).scenario_of(identity, map=map)

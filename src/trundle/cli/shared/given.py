"""Arguments of the wrong kind: messages that say what was given and what to give instead."""

from __future__ import annotations

import os

from trundle.errors import InputError
from trundle.files.kinds import (
    DRIVE,
    EVALUATION,
    MAP,
    PICTURE,
    ROBOT,
    RUN,
    SCENARIO,
    SUITE,
    WORLD,
    describe_mismatch,
    find_kind,
)

_ADVICE = {
    (WORLD, MAP): "make its map with trundle map build {text} -o map.yaml",
    (SCENARIO, MAP): "give its map, or drive it with trundle run {text}",
    (SCENARIO, WORLD): "give its world or map, or drive it with trundle run {text}",
    (PICTURE, MAP): "give the map's YAML file, which has the image's name and the resolution",
    (PICTURE, WORLD): "of a map give the YAML file, which has the image's name and the resolution",
    (ROBOT, WORLD): "give it with --robot {text}",
    (ROBOT, MAP): "give it with --robot {text}",
    (WORLD, ROBOT): "give a robot first, and this with --world {text}",
    (MAP, ROBOT): "give a robot first, and this with --world {text}",
    (SCENARIO, ROBOT): "give its robot",
    (RUN, SCENARIO): "to repeat it give {text}/scenario.yaml",
    (RUN, MAP): "give the YAML file of a map",
    (DRIVE, RUN): "a drive has no replay; trundle compare reads it",
    (SUITE, RUN): "run it with trundle evaluate {text}",
    (SCENARIO, RUN): "run it with trundle run {text}, and give the folder that it writes",
    (RUN, EVALUATION): "compare runs with trundle compare; the figures and pictures of one are in its folder",
    ("a folder", EVALUATION): "give the folder that trundle evaluate wrote",
    (DRIVE, EVALUATION): "compare drives with trundle compare",
    (EVALUATION, RUN): "compare evaluations with trundle evaluate compare, or run one of its episodes again with "
    "trundle run --from {text}:ID",
    (EVALUATION, SCENARIO): "to run one of its episodes again, trundle run --from {text}:ID; to resume it, "
    "trundle evaluate {text}/suite.yaml -o {text}",
    (EVALUATION, SUITE): "to continue it, trundle evaluate {text}/suite.yaml -o {text}; its report, trundle evaluate "
    "report {text}",
    (SUITE, SCENARIO): "run its episodes with trundle evaluate {text}",
    (SUITE, EVALUATION): "run it with trundle evaluate {text}, and give the folder that it writes",
    (EVALUATION, MAP): "give the YAML file of a map",
    (DRIVE, SCENARIO): "to repeat its commands, trundle drive ROBOT --like {text}",
    (
        "a simulator",
        RUN,
    ): "drive with trundle drive ROBOT --like RUN --backend {text}, and compare the folders",
    ("a folder", MAP): "give the YAML file of a map in it",
}


def check_given(text: str | os.PathLike[str], *wanted: str) -> None:
    """Refuse a file or a name that is clearly of another kind than those wanted; the first of them is the main one.

    A missing file or unknown name is left to the loader to report.

    Raises:
        InputError: If it is of another kind; the message says what to give instead.
    """
    text = os.fspath(text)
    # A file or folder may have a known name: `drive -o mujoco` creates one.
    found = find_kind(text)
    kinds = [*_kinds_of_name(text), *([] if found is None else [found])]
    if not kinds or set(kinds) & set(wanted):
        return
    advice = next((_ADVICE[kinds[0], kind] for kind in wanted if (kinds[0], kind) in _ADVICE), None)
    *others, last = wanted
    message = describe_mismatch(text, kinds[0], f"{', '.join(others)} or {last}" if others else last)
    raise InputError(message if advice is None else f"{message}; {advice.format(text=text)}")


def _kinds_of_name(text: str) -> list[str]:
    """The kinds of known things with this name."""
    from trundle.control import controller_names
    from trundle.planning import planner_names
    from trundle.robots import robot_names
    from trundle.sim import simulator_names
    from trundle.worlds import world_names

    names = {
        WORLD: world_names,
        ROBOT: robot_names,
        "a planner": planner_names,
        "a controller": controller_names,
        "a simulator": simulator_names,
    }
    return [kind for kind, known in names.items() if text in known()]

"""`--nav2-params`: Nav2's parameters as settings, and those that trundle takes differently or does not have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from trundle.cli.shared import output

if TYPE_CHECKING:
    from trundle.mission import Scenario
    from trundle.nav2 import Remark

Nav2Params = Annotated[
    Path | None,
    Parameter(
        name="--nav2-params",
        metavar="YAML",
        negative="",
        help="Nav2's parameter file. Footprint, costmap, planner, controller, checkers, limits and monitor are taken "
        "from it, and parameters that trundle does not have are listed. It overrides a scenario, and the other "
        "options override it.",
    ),
]


@dataclass(slots=True)
class Nav2Report:
    """What became of the parameters of a file.

    Attributes:
        file: The file, or None if none was given.
        remarks: Parameters that mean something else in trundle, or have no counterpart.
    """

    file: Path | None = None
    remarks: list[Remark] = field(default_factory=list)

    @property
    def facts(self) -> dict[str, object]:
        """The members of a verb's JSON value; empty if no file was given."""
        return {} if self.file is None else {"nav2_params": {"file": self.file, "remarks": self.remarks}}

    def tell(self, *, quiet: bool) -> None:
        """Print it on stderr; with --quiet one line that says how much there is."""
        if self.file is None:
            return
        from trundle.nav2 import describe_remarks

        changed = sum(remark.kind == "changed" for remark in self.remarks)
        rest = len(self.remarks) - changed
        head = f"{self.file}: parameters with another meaning in trundle: {changed}, without counterpart: {rest}"
        if quiet:
            output.remark(f"{head}; --json lists them", quiet=False)
            return
        output.remark("\n  ".join([f"{head}:", *describe_remarks(self.remarks)]), quiet=False)


def add_to_suite(
    file: Path, robots: Sequence[str], changes: dict[str, object], report: Nav2Report
) -> dict[str, object]:
    """Return the fields of a suite that a parameter file gives, and `changes`.

    Args:
        file: The file.
        robots: The suite's robots.
        changes: Fields that options give, which come first.
        report: Where the remarks are put.

    Raises:
        InputError: If the file cannot be used.
    """
    from trundle.evaluation import Suite
    from trundle.nav2 import Remark, read_nav2_params

    found = read_nav2_params(file, robots[0] if len(robots) == 1 else None)
    report.file = file
    report.remarks += found.remarks
    settings: dict[str, object] = {}
    for name, value in found.settings.items():
        field_name = f"{name}s" if name in ("planner", "controller", "smoother") else name
        if field_name in Suite.model_fields:
            settings[field_name] = [value]
        else:
            advice = (
                "a suite's missions say where robots start" if name == "start" else "give it with the suite's worlds"
            )
            report.remarks.append(Remark("no counterpart", "", name, str(value), advice))
    return {**settings, **changes}


def translate(
    file: Path | None, scenario: Scenario, changes: dict[str, object], report: Nav2Report
) -> dict[str, object]:
    """Return the fields of a scenario that a parameter file gives, and `changes`; without a file nothing.

    Args:
        file: The file.
        scenario: The scenario that gets them; its start stays.
        changes: Fields that options give, which come first.
        report: Where the remarks are put.

    Raises:
        InputError: If the file cannot be used.
    """
    if file is None:
        return {}
    from trundle.nav2 import read_nav2_params

    masks = {name for name in ("keepout", "speed_mask") if getattr(scenario, name) is not None}
    found = read_nav2_params(file, scenario.robot, given=masks | set(changes))
    report.file = file
    report.remarks += found.remarks
    settings = dict(found.settings)
    if scenario.start is not None:
        settings.pop("start", None)
    if changes.get("lidar") is False:  # a monitor without scans would stop the robot for ever
        settings.pop("collision_monitor", None)
        settings.pop("localizer", None)
        settings.pop("known_map", None)
    return {**settings, **changes}

"""`trundle export --to nav2`: a scenario, a map or a world with a robot as a folder for Nav2."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from trundle.cli.shared import output
from trundle.cli.shared.nav2 import Nav2Report
from trundle.errors import InputError

if TYPE_CHECKING:
    from trundle.cli.shared.scenarios import ScenarioOptions
    from trundle.messages.codec import Distro

FORMAT = "nav2"
"""Of `trundle export --to`."""


def export(
    source: str, given: ScenarioOptions, out: Path | None, distro: Distro | None, *, json: bool, quiet: bool
) -> int:
    """Write the folder; see `export_nav2` for the errors."""
    from trundle.messages.codec import DEFAULT
    from trundle.nav2 import describe_remarks, export_nav2
    from trundle.nav2.export import LAUNCH, REMARKS

    told = Nav2Report()
    scenario = given.make(source, told)
    told.tell(quiet=quiet)
    folder = Path(f"{Path(source).stem}_nav2") if out is None else out
    if folder.suffix and not folder.is_dir():
        raise InputError(f"--out {folder}: give a folder for Nav2's files")
    done = export_nav2(scenario, folder, distro=distro or DEFAULT)
    facts: dict[str, object] = {"robot": scenario.robot, "format": FORMAT, "folder": done.folder, "files": done.files}
    if quiet:
        output.remark(f"{folder / REMARKS}: {len(done.remarks)} settings", quiet=False)
    elif done.remarks:
        head = f"What Nav2 has otherwise, or not at all ({REMARKS}):"
        output.remark("\n  ".join([head, *describe_remarks(done.remarks)]), quiet=False)
    if json:
        output.print_json({**facts, "remarks": done.remarks, **told.facts})
        return 0
    output.print_facts({**facts, "files": ", ".join(done.files)})
    output.remark(f"To drive with it: ros2 launch {folder / LAUNCH}", quiet=quiet)
    return 0

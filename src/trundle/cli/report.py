"""`trundle report`: write the report of a run again, or for the first time."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import options, output
from trundle.cli.shared.given import check_given
from trundle.files.kinds import RUN

app = App(
    name="report",
    version_flags=[],
    help_epilogue="Examples:\n  trundle report runs/first\n  trundle report runs/first -o first.html",
)


@app.default
def report(
    run: Path,
    /,
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Write report.html of a run: its replay, plots, verdict, settings, versions, and the command that repeats it.

    Every run writes it; this makes it for runs that have none, and again with this version's page.

    Args:
        run: The folder that trundle run wrote.
        out: The file, or a folder for report.html; default: report.html in the run's folder.
    """
    from trundle.page.report import report_folder

    check_given(run, RUN)
    target = None if out is None else options.output_file(out, "report.html", (".html",))
    file = report_folder(run, target)
    if json:
        output.print_json({"report": file})
    else:
        output.print_facts({"report": file})
    return 0

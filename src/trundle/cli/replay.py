"""`trundle replay`: watch a run again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import options, output
from trundle.cli.shared.given import check_given
from trundle.files.kinds import RUN

app = App(
    name="replay",
    version_flags=[],
    help_epilogue="Examples:\n  trundle replay runs/first --browser",
)


@app.default
def replay(
    run: Path,
    /,
    *,
    browser: Annotated[bool, Parameter(negative="")] = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Print the page that replays a run, and open it; it is made first where the run has none.

    The page is report.html in the run's folder: one file, which needs no server and opens by a double click.

    Args:
        run: The folder that trundle run wrote.
        browser: Open the page in the browser.
    """
    from trundle.cli.shared.browser import open_browser
    from trundle.files.opening import is_file
    from trundle.mission.run_files import read_record
    from trundle.page.report import REPORT, report_folder

    check_given(run, RUN)
    read_record(run)
    file = run / REPORT if is_file(run / REPORT) else report_folder(run)
    address = file.resolve().as_uri()
    if json:
        output.print_json({"replay": file, "address": address})
    else:
        output.print_facts({"replay": address})
    if browser and not open_browser(address):
        output.remark("No browser was found here: copy the file to a machine with one, and open it there", quiet=quiet)
    return 0

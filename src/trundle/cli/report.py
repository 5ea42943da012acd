"""`trundle report` and `trundle replay`: the page of a run, written again or for the first time, and opened."""

from __future__ import annotations

from pathlib import Path

from cyclopts import App

from trundle.cli.shared import options, output
from trundle.cli.shared.sources import check_given
from trundle.files.kinds import RUN

app = App(
    name="report",
    version_flags=[],
    help_epilogue="Examples:\n  trundle report runs/first\n  trundle report runs/first -o first.html",
)

replay_app = App(
    name="replay",
    version_flags=[],
    help_epilogue="Examples:\n  trundle replay runs/first --browser",
)


@app.default
def report(
    run: Path,
    /,
    *,
    out: options.Out = None,
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


@replay_app.default
def replay(
    run: Path,
    /,
    *,
    browser: options.Flag = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Print the page that replays a run, and open it; it is made first where the run has none.

    The page is report.html in the run's folder: one file, which needs no server and opens by a double click.

    Args:
        run: The folder that trundle run wrote.
        browser: Open the page in the browser.
    """
    from trundle.cli.shared.browser import has_screen, open_browser
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
        why = "No browser was found here" if has_screen() else "There is no display here, so no browser was opened"
        output.remark(f"{why}. Copy {file} to a machine with one; the address here is {address}", quiet=quiet)
    return 0

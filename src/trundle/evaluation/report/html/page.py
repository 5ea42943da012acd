"""`render_page`: the report of an evaluation as one HTML file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

from trundle.evaluation.report.html.changes import comparisons, variations
from trundle.evaluation.report.html.failure_table import failure_table, has_own_worlds
from trundle.evaluation.report.html.head import groups, tiles, verdict
from trundle.evaluation.report.html.marks import definitions
from trundle.evaluation.report.html.places import Maps, failure_cards, find_places, map_definitions, world_maps
from trundle.evaluation.report.html.spread import distributions, extremes
from trundle.evaluation.report.html.style import STYLE
from trundle.evaluation.statistics.comparison import compare_within
from trundle.evaluation.statistics.gates import GateResult
from trundle.evaluation.statistics.table import Table
from trundle.evaluation.store.manifest import Stopped


def render_page(
    table: Table,
    *,
    name: str,
    folder: str,
    total: int | None = None,
    gates: Sequence[GateResult] = (),
    maps: Maps = lambda _: None,
    facts: Mapping[str, str] | None = None,
    stopped: Stopped | None = None,
) -> str:
    """The page: verdict first, then success, comparisons, maps with failures, distributions and variations.

    It makes no request, has no script, and is the same for the same rows.

    Args:
        table: The rows so far.
        name: Of the evaluation.
        folder: Its folder, for the commands.
        total: How many episodes there are to be; none means those that there are.
        gates: The results of what is required.
        maps: Gives the map of a world by the key in a row's `place`; None where it is not known.
        facts: What else is to be said at the top: versions, the command, when it was run.
        stopped: Why not all episodes have a row, where that is known.
    """
    total = len(table) if total is None else total
    body = [verdict(table, name, total, gates, facts or {}, stopped)]
    if len(table):
        places = find_places(table, maps)
        if has_own_worlds(table, places):
            failures = [failure_table(table, places, folder)]
        else:
            failures = [world_maps(table, places), failure_cards(table, places, folder)]
        body += [
            tiles(table),
            groups(table, gates),
            comparisons(compare_within(table, name)),
            map_definitions(places),
            *failures,
            variations(table),
            distributions(table),
            extremes(table, folder),
        ]
    else:
        body.append("<p>No episode is done yet.</p>")
    body.append(
        "<footer>Made by trundle evaluate. An episode has arrived when the robot stands at its goal and touched "
        "nothing. SPL is success weighted by path length, against the true shortest path.</footer>"
    )
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; img-src data:; '
        "style-src 'unsafe-inline'\">"
        f"<title>{escape(name)} – trundle evaluate</title><style>{STYLE}</style></head>\n<body>{definitions()}\n"
        + "\n".join(part for part in body if part).replace(" %", "\u00a0%")
        + "\n</body></html>\n"
    )

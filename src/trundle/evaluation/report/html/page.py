"""`render_page`: the report of an evaluation as one HTML file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

from trundle.evaluation.report.html.changes import comparisons, variations
from trundle.evaluation.report.html.charts import definitions
from trundle.evaluation.report.html.failure_table import failure_table, has_own_worlds
from trundle.evaluation.report.html.head import groups, tiles, verdict
from trundle.evaluation.report.html.places import Maps, failure_cards, find_places, map_definitions, world_maps
from trundle.evaluation.report.html.spread import distributions, extremes
from trundle.evaluation.statistics.comparison import compare_within
from trundle.evaluation.statistics.gates import GateResult
from trundle.evaluation.statistics.table import Table
from trundle.evaluation.store.folder import Stopped


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
    """Return the page: verdict first, then success, comparisons, maps with failures, distributions and variations.

    It makes no request, has no script, and is the same for the same rows.

    Args:
        table: The rows so far.
        name: Name of the evaluation.
        folder: Its folder, for the commands.
        total: How many episodes there are to be; by default those that have a row.
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


STYLE = """
:root{color-scheme:light dark;--page:#fff;--card:#f6f7f9;--ink:#1f2430;--faint:#5b6472;--line:#d6dae2;--code:#eceff3;
--good:#1b7837;--bad:#b2182b;--warn:#8a5a00;--accent:#2563cd;--trail:#2563cd;--fail:#c2410c;--free:#fcfcfd;
--arrived:#1b7f5c;--collided:#c5270c;--stuck:#b85c00;--timed_out:#94257a;--no_path:#0068a8;--broken:#4b5563;
--close:#00796b;--arrived_by_estimate:#6b7a00;--finished:#3f51b5}
@media screen and (prefers-color-scheme:dark){:root{--page:#14171d;--card:#1c2129;--ink:#e6e9ef;--faint:#a2abba;
--line:#363d4a;--code:#272d38;--good:#5fcf86;--bad:#ff8a80;--warn:#f0b34a;--accent:#7fb0ff;--trail:#7fb0ff;
--fail:#ff9d5c;--free:#181b21;--arrived:#4fc39b;--collided:#ff7a66;--stuck:#ffa64d;--timed_out:#e58ad3;
--no_path:#6dbdf2;--broken:#c3cad6;--close:#4fd1c0;--arrived_by_estimate:#c3d34a;--finished:#9fa8f0}
.map{filter:invert(.9) hue-rotate(180deg)}}
*{box-sizing:border-box}
body{margin:0 auto;padding:1.25rem;max-width:75rem;background:var(--page);color:var(--ink);
font:1rem/1.45 system-ui,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif}
h1{font-size:1.7rem;line-height:1.2;margin:.2rem 0 .5rem;overflow-wrap:anywhere}
h2{font-size:1.25rem;margin:2.2rem 0 .3rem}
h3{font-size:1.02rem;margin:1.2rem 0 .3rem;overflow-wrap:anywhere}
p{margin:.3rem 0 .8rem;max-width:62rem}
.note,figcaption,.tile small{color:var(--faint);font-size:.88rem}
code{background:var(--code);border-radius:4px;padding:.1em .35em;overflow-wrap:anywhere;
font:.85em ui-monospace,SFMono-Regular,Menlo,Consolas,"DejaVu Sans Mono",monospace}
.badge{display:inline-block;border:2px solid;border-radius:7px;padding:.05em .55em;font-weight:700;margin-right:.4em;
font-size:1.1rem;vertical-align:.12em}
.good{color:var(--good)}.bad{color:var(--bad)}.warn{color:var(--warn)}
.banner{border-left:5px solid var(--warn);background:var(--card);padding:.6rem .9rem;margin:.8rem 0;max-width:none}
ul.gates{list-style:none;padding:0;margin:.6rem 0}
ul.gates li{padding:.3rem 0;border-top:1px solid var(--line)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(10.5rem,1fr));gap:.7rem;margin:1rem 0}
.tile,.card,figure{background:var(--card);border:1px solid var(--line);border-radius:9px;padding:.7rem .85rem;margin:0}
.tile b{display:block;font-size:1.5rem;line-height:1.25}
.tile small{display:block}
.wide{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums;font-size:.94rem}
th,td{padding:.34rem .6rem;text-align:right;border-top:1px solid var(--line);vertical-align:middle}
td{white-space:nowrap}td.text,table.stack td.text{white-space:normal}
thead th{border-top:0;color:var(--faint);font-weight:600;font-size:.86rem;vertical-align:bottom}
th:first-child,td:first-child,td.text,th.text,td.word{text-align:left}
td.mid,th.mid{text-align:center}
tbody th{font-weight:600;overflow-wrap:break-word}
.ci{display:inline-block;min-width:10em;color:var(--faint)}
.count{white-space:nowrap;margin-right:.5em}
.icon{width:1em;height:1em;vertical-align:-.14em;margin-right:.28em}
svg{display:block;width:100%;height:auto}
.icon,svg.bar,svg.interval{display:inline-block}
svg.interval{width:13rem;height:1.5rem;vertical-align:middle}
svg.bar{width:9rem;height:1.1rem;vertical-align:middle}
svg text{fill:var(--faint);font-family:inherit}
.axis{stroke:var(--line)}.grid{stroke:var(--line);stroke-width:.7}
.range{stroke:var(--accent);stroke-width:3}.dot{fill:var(--accent)}.zero{stroke:var(--faint);stroke-dasharray:3 3}
.bound{stroke:var(--bad);stroke-width:1.6;stroke-dasharray:4 2}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,20rem),1fr));gap:.9rem;margin:.7rem 0}
.maps{align-items:start;grid-template-columns:repeat(auto-fit,minmax(min(100%,27rem),1fr))}
.charts{grid-template-columns:repeat(auto-fit,minmax(min(100%,26rem),1fr))}
.cards{grid-template-columns:repeat(auto-fill,minmax(min(100%,20rem),1fr))}
.maps svg{max-height:44rem}
figure b{font-size:.96rem}
.map{image-rendering:pixelated}
.bare{fill:var(--free);stroke:var(--line)}
.trail{fill:none;stroke:var(--trail);stroke-width:1.4;opacity:.45;stroke-linejoin:round}
.lost{fill:none;stroke:var(--fail);stroke-width:1.4;opacity:.65;stroke-linejoin:round}
.route{fill:none;stroke:var(--trail);stroke-width:2.4;stroke-linejoin:round}
.halo{fill:none;stroke:var(--page);stroke-width:5;opacity:.75}
.aim{fill:none;stroke:var(--good);stroke-width:1.4;stroke-dasharray:2 4}
.ring{fill:none;stroke:var(--ink);stroke-width:1.6}
.number circle{fill:var(--ink);stroke:var(--page);stroke-width:3}
.number text{fill:var(--page);font-weight:700;text-anchor:middle}
.scale{stroke:var(--ink);stroke-width:2}.under{stroke:var(--page);stroke-width:5;opacity:.8}
.scaletext{fill:var(--ink);stroke:var(--page);stroke-width:3;paint-order:stroke}
.start{fill:#fff;stroke:var(--accent);stroke-width:3}.goal{fill:none;stroke:var(--good);stroke-width:3.5}
.card{padding:0;overflow:hidden;display:flex;flex-direction:column}
.card>div{padding:.6rem .8rem .75rem}
.card p{margin:.25rem 0}
.thumbs svg[role=img]{width:12rem;border-radius:5px}.thumbs td.text{max-width:26rem}
.no{display:inline-block;min-width:1.5em;text-align:center;border-radius:1em;background:var(--ink);color:var(--page);
font-weight:700;font-size:.86rem;margin-right:.35em;padding:0 .3em}
details{margin:.3rem 0}summary{cursor:pointer;color:var(--accent)}
details code{display:inline-block;margin:.15rem 0}
.key{display:flex;flex-wrap:wrap;gap:.2rem 1rem;font-size:.88rem;margin:.4rem 0}
.key svg.line{display:inline-block;width:2.2em;height:.8em;vertical-align:-.05em;margin-right:.35em}
.defs{position:absolute;width:0;height:0}
.c-arrived{color:var(--arrived);fill:var(--arrived)}.c-collided{color:var(--collided);fill:var(--collided)}
.c-stuck{color:var(--stuck);fill:var(--stuck)}.c-timed_out{color:var(--timed_out);fill:var(--timed_out)}
.c-no_path{color:var(--no_path);fill:var(--no_path)}.c-broken{color:var(--broken);fill:var(--broken)}
.c-close{color:var(--close);fill:var(--close)}.c-finished{color:var(--finished);fill:var(--finished)}
.c-arrived_by_estimate{color:var(--arrived_by_estimate);fill:var(--arrived_by_estimate)}
footer{margin-top:2.5rem;border-top:1px solid var(--line);padding-top:.6rem;color:var(--faint);font-size:.85rem}
@media(max-width:40rem){body{padding:.8rem}th,td{padding:.3rem .25rem}
table{font-size:.86rem}table.stack{font-size:.94rem}
.ci{min-width:0}
table.stack thead{display:none}table.stack tr{display:block;border-top:1px solid var(--line);padding:.45rem 0}
table.stack th,table.stack td{display:block;border:0;padding:.1rem 0;text-align:left}
table.stack td[data-name]::before{content:attr(data-name) " ";color:var(--faint);font-size:.86rem}
table.stack td{white-space:normal;display:inline-block;margin-right:.9rem}
table.stack td.mid,table.stack td.text{display:block;margin:0}
table.stack svg.interval{width:100%;height:auto}table.stack svg.bar{width:100%;height:.8rem}}
@media print{:root{font-size:10.5px}body{max-width:none;padding:0}td{white-space:normal}td.mid br{display:none}
svg.interval{width:10rem}svg.bar{width:6rem}h2,h3{break-after:avoid}
.card,figure,tr,.tile{break-inside:avoid}.figures{grid-template-columns:1fr 1fr}
*{-webkit-print-color-adjust:exact;print-color-adjust:exact}}
"""

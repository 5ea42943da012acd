"""`trundle map`: verbs about occupancy maps."""

from __future__ import annotations

from cyclopts import App

app = App(
    name="map",
    help_epilogue=(
        "Examples:\n"
        "  trundle map build warehouse -o map.yaml\n"
        "  trundle map from-bag run.mcap -o map.yaml\n"
        "  trundle map check map.yaml --world warehouse\n"
        "  trundle map convert map.yaml -o coarse.yaml --resolution 0.1"
    ),
    version_flags=[],
)
app.command("trundle.cli.map.build:app", name="build", help="Make the occupancy map of a world.")
app.command("trundle.cli.map.check:app", name="check", help="Find mistakes in a map, and fix them.")
app.command("trundle.cli.map.convert:app", name="convert", help="Convert, resample, crop or merge maps.")
app.command("trundle.cli.map.from_bag:app", name="from-bag", help="Make a map from a recorded drive.")
app.command("trundle.cli.map.extend:app", name="continue", help="Continue a map with another drive.")
app.command("trundle.cli.map.from_graph:app", name="from-graph", help="Draw, move or merge pose graphs.")

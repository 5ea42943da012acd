"""`trundle map`: verbs about occupancy maps."""

from __future__ import annotations

from cyclopts import App

app = App(
    name="map",
    help_epilogue=(
        "Examples:\n"
        "  trundle map build warehouse -o map.yaml\n"
        "  trundle map check map.yaml --world warehouse\n"
        "  trundle map convert map.yaml -o coarse.yaml --resolution 0.1"
    ),
    version_flags=[],
)
app.command("trundle.cli.map.build:app", name="build", help="Make the occupancy map of a world.")
app.command("trundle.cli.map.check:app", name="check", help="Find mistakes in a map, and fix them.")
app.command("trundle.cli.map.convert:app", name="convert", help="Convert, resample, crop or merge maps.")

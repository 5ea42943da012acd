"""`trundle map`: verbs about occupancy maps."""

from __future__ import annotations

from cyclopts import App

app = App(name="map", help_epilogue="Example:\n  trundle map build warehouse -o map.yaml", version_flags=[])
app.command("trundle.cli.map_build:app", name="build", help="Make the occupancy map of a world.")

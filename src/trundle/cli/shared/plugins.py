"""Names that installed packages add, for --help: read from their metadata, without importing them."""

from __future__ import annotations

from importlib.metadata import entry_points

GROUPS = {
    "robots": "trundle.robots",
    "worlds": "trundle.worlds",
    "planners": "trundle.planners",
    "controllers": "trundle.controllers",
    "smoothers": "trundle.smoothers",
    "agents": "trundle.agents",
    "localizers": "trundle.localizers",
    "simulators": "trundle.simulators",
    "behaviors": "trundle.behaviors",
}
"""Kinds of plug-ins, each with its entry-point group."""


def describe_plugins() -> str:
    """One line per kind of plug-in that is installed; empty if there are none."""
    names = {kind: sorted(entry_points(group=group).names) for kind, group in GROUPS.items()}
    lines = [f"  {kind}: {', '.join(found)}" for kind, found in names.items() if found]
    return "\n".join(["Plug-ins installed:", *lines]) if lines else ""

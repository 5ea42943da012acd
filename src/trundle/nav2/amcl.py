"""AMCL and trundle's localizer of that name, read and written."""

from __future__ import annotations

from typing import cast

from trundle.messages.makers import scan_topic
from trundle.nav2.draft import Block, Draft
from trundle.nav2.notes import Notes
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.table import AMCL, read_given

NAME = "amcl"

_LEAST, _FEWEST = 10, 500
"""The least number of particles or beams that trundle's filter takes, and Nav2's default of `min_particles`."""

_MOST = {"min_particles": 100_000, "max_particles": 100_000, "max_beams": 10_000}
_LONGEST_M = 1e3
"""Lidars' beams are no longer: a `laser_max_range` above it means no limit."""


def read_localizer(amcl: NodeParameters, notes: Notes) -> dict[str, object]:
    """Read trundle's localizer `amcl` with the options that the file gives; the others keep trundle's defaults.

    Raises:
        InputError: If a parameter cannot be used.
    """
    options: dict[str, object] = {**read_given(AMCL, amcl), **_read_counts(amcl, notes)}
    if options.get("z_rand") == 0.0:
        del options["z_rand"]
        notes.changed(amcl, "z_rand", "a beam may always end anywhere: trundle's default counts")
    if amcl.has("laser_max_range"):
        longest = amcl.number("laser_max_range", 0.0)
        if 0.0 < longest <= _LONGEST_M:
            options["laser_max_range"] = longest
    if "differential" not in amcl.text("robot_model_type", "differential").lower():
        notes.changed(amcl, "robot_model_type", "trundle's robots do not drive sideways: a differential drive")
    if amcl.text("laser_model_type", "likelihood_field") == "beam":
        notes.changed(amcl, "laser_model_type", "trundle's filter has a field of distances, as likelihood_field")
    return {"name": NAME, "options": options}


def _read_counts(amcl: NodeParameters, notes: Notes) -> dict[str, int]:
    """Read the numbers of particles and beams that the file gives."""
    counts: dict[str, int] = {}
    for name, most in _MOST.items():
        if amcl.has(name):
            counts[name] = amcl.integer(name, 0, least=_LEAST)
            if counts[name] > most:
                raise amcl.wrong(name, f"must be at most {most}")
    fewest, largest = counts.get("min_particles", _FEWEST), counts.get("max_particles", _MOST["max_particles"])
    if largest < fewest:
        if "min_particles" in counts:
            raise amcl.wrong("max_particles", f"must be at least min_particles, {fewest}")
        counts["min_particles"] = largest
        notes.changed(amcl, "max_particles", f"it is below Nav2's min_particles, {fewest}: trundle uses it for both")
    return counts


def read_start(amcl: NodeParameters) -> tuple[float, float, float] | None:
    """Read the initial pose that the file gives AMCL, or None if it does not give one.

    Raises:
        InputError: If a coordinate is no number.
    """
    if not amcl.flag("set_initial_pose", False):
        return None
    pose = amcl.of_plugin("initial_pose")
    pose.number("z", 0.0)
    return pose.number("x", 0.0), pose.number("y", 0.0), pose.number("yaw", 0.0)


def write_amcl(draft: Draft) -> Block:
    """Write AMCL, with the options of trundle's `amcl` that are not its defaults; the others are Nav2's own."""
    names = draft.lidars or tuple(draft.robot.lidars)
    block: Block = {
        "global_frame_id": "map",
        "odom_frame_id": "odom",
        "base_frame_id": "base_link",
        "robot_model_type": "nav2_amcl::DifferentialMotionModel",
        "tf_broadcast": True,
        "transform_tolerance": 1.0,
    }
    if names:
        block["scan_topic"] = scan_topic(names[0], draft.robot)
    block |= _write_options(draft)
    start = draft.scenario.start
    if start is not None:
        x, y, yaw = (*start, 0.0)[:3]
        block["set_initial_pose"] = True
        block["initial_pose"] = {"x": float(x), "y": float(y), "z": 0.0, "yaw": float(yaw)}
    return block


def _write_options(draft: Draft) -> Block:
    localizer = draft.scenario.localizer
    if localizer is None:
        return {}
    if localizer.name != NAME:
        draft.left_out("localizer", localizer.name, "Nav2 has AMCL")
        return {}
    known = {*(row.parameter for row in AMCL), *_MOST, "laser_max_range"}
    draft.leave_options("localizer", localizer.options, known, {}, "Nav2's AMCL has nothing like it")
    return cast("Block", {name: value for name, value in localizer.options.items() if name in known})

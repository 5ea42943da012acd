"""Writing a world as a USD stage; usd-core is imported on use."""

from __future__ import annotations

import os
from typing import Literal, TypeAlias

from trundle.errors import UnknownNameError
from trundle.worlds import World
from trundle.worlds.usd import need_usd

Profile: TypeAlias = Literal["isaac"]
"""Targets that a stage can be adapted to, besides UsdPhysics."""

PROFILES: tuple[Profile, ...] = ("isaac",)


def write_world(world: World, path: str | os.PathLike[str], *, profile: Profile | None = None) -> None:
    """Write a world as a USD stage; see `trundle.export.usd.export_world`."""
    check_profile(profile)
    from trundle.usd.stage import save
    from trundle.usd.world import world_stage

    stage = world_stage(world)
    if profile == "isaac":
        from trundle.usd.isaac import fit_for_isaac

        fit_for_isaac(stage)
    save(stage, path)


def check_profile(profile: str | None) -> None:
    """Check that a stage can be written for a profile.

    Raises:
        UnknownNameError: If there is no such profile.
        MissingExtraError: If usd-core is not installed.
    """
    if profile is not None and profile not in PROFILES:
        raise UnknownNameError("profile", profile, PROFILES)
    need_usd("writing USD")

"""Which evaluation may be continued with a suite and a version of the code."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import yaml

from trundle.errors import OutputError
from trundle.evaluation.store.code import describe_differences
from trundle.evaluation.store.layout import SUITE
from trundle.evaluation.store.manifest import Manifest


def check_continues(folder: Path, new: Manifest, suite_text: str, *, mixed: bool) -> Manifest:
    """The manifest with which the evaluation in a folder goes on.

    Args:
        folder: Of the evaluation.
        new: The manifest that a new evaluation would have.
        suite_text: The suite that is to be evaluated.
        mixed: Whether its rows may be made by different code.

    Raises:
        OutputError: If it is of another suite, or its rows were made by other code and `mixed` is not set.
    """
    old = Manifest.load(folder)
    if old.name != new.name:
        raise OutputError(
            f"{folder} holds the evaluation of another suite, {old.name!r} with {old.total} episodes, not "
            f"{new.name!r}{_describe_changes(folder, suite_text)}; give another folder with -o, "
            f"replace that evaluation with --overwrite, or continue it with your suite by `name: {old.name}` in it"
        )
    differences = describe_differences(old.versions, new.versions)
    if not differences:
        return replace(new, started=old.started, earlier_versions=old.earlier_versions)
    if not mixed:
        raise OutputError(
            f"{folder}: the rows that are there were made with other code ({differences}); give another folder with -o "
            "to compare the two, replace them with --overwrite, or keep them with --mixed"
        )
    return replace(new, started=old.started, earlier_versions=(*old.earlier_versions, old.versions))


def _describe_changes(folder: Path, suite_text: str) -> str:
    """Name the parts in which the two suites differ."""
    try:
        old, new = (yaml.safe_load(text) for text in ((folder / SUITE).read_text(), suite_text))
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        return ""
    if not isinstance(old, Mapping) or not isinstance(new, Mapping):
        return ""
    keys = [str(key) for key in dict.fromkeys((*old, *new)) if key != "name" and old.get(key) != new.get(key)]
    return f" (they differ in {', '.join(keys)})" if keys else ""

"""Settings of a robot's file over those that it builds on."""

from __future__ import annotations

from trundle.files.yaml_config import Plain


def merge_settings(below: dict[str, Plain], given: dict[str, Plain]) -> dict[str, Plain]:
    """Merge given settings over others, key by key, also within mappings; lists are replaced as a whole."""
    merged = dict(below)
    for key, value in given.items():
        old = merged.get(key)
        merged[key] = merge_settings(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return merged

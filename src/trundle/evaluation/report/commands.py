"""The command that runs an episode again."""

from __future__ import annotations

import shlex

_DIGITS = 12
"""Of an id: enough to tell a million episodes apart."""


def short_id(episode: str) -> str:
    """As much of an id as tells it from all others."""
    return episode[:_DIGITS]


def replay_command(folder: str, episode: str) -> str:
    """The command that runs an episode of the evaluation in a folder again, quoted for a shell."""
    return f"trundle run --from {shlex.quote(f'{folder}:{short_id(episode)}')}"

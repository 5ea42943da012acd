"""Which of several plugins counts, and its type."""

from __future__ import annotations

from trundle.nav2.names import plain_plugin
from trundle.nav2.parameters import NodeParameters
from trundle.nav2.reading.notes import Notes


def choose_plugin(
    node: NodeParameters, lists: tuple[str, ...], default: str, default_plugin: str, notes: Notes
) -> tuple[str, str]:
    """The name and the type of the plugin that Nav2's default behavior tree calls.

    Args:
        node: The server's parameters.
        lists: Parameters that list the plugins' names, of which distributions have one or the other.
        default: The name that counts where it is in the list, and where there is no list; else the first one does.
        default_plugin: The type, where the file gives none.
        notes: Where the others are noted.

    Raises:
        InputError: If a list is none of names, or a type is no text.
    """
    chosen = default
    for key in lists:
        names = node.texts(key, ())
        if names:
            chosen = default if default in names else names[0]
        if len(names) > 1:
            notes.changed(node, key, f"trundle uses one: {chosen}")
    return chosen, plain_plugin(node.of_plugin(chosen).text("plugin", default_plugin))

"""`RunLog`: rows, paths and events of a run as messages, of which every client gets everything."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from trundle.serve.encoding import encode_items

_BATCH_BYTES = 256 * 1024
"""A client that catches up gets messages of about this size."""


@dataclass(frozen=True, slots=True)
class _Chunk:
    first: int
    rows: str
    paths: str
    events: str

    def __len__(self) -> int:
        return len(self.rows) + len(self.paths) + len(self.events)


class RunLog:
    """What a run has told so far, encoded once for all clients, each of which has a cursor in it."""

    def __init__(self) -> None:
        self._chunks: list[_Chunk] = []
        self._rows = 0

    def add(self, rows: Sequence[object], paths: Sequence[object], events: Sequence[object]) -> None:
        """Append what is new."""
        if rows or paths or events:
            self._chunks.append(_Chunk(self._rows, *map(encode_items, (rows, paths, events))))
            self._rows += len(rows)

    def read(self, cursor: int) -> tuple[str, int] | None:
        """The `log` message for a client whose cursor is here, and its next cursor; None where it has everything.

        Cursors start at 0. A page takes "from": 0 for the beginning of everything: a message that goes on before there
        are rows has none.
        """
        size, end = 0, cursor
        while end < len(self._chunks) and (end == cursor or size + len(self._chunks[end]) <= _BATCH_BYTES):
            size += len(self._chunks[end])
            end += 1
        if end == cursor:
            return None
        part = self._chunks[cursor:end]
        rows = ",".join(chunk.rows for chunk in part if chunk.rows)
        paths = ",".join(chunk.paths for chunk in part if chunk.paths)
        events = ",".join(chunk.events for chunk in part if chunk.events)
        first = f'"from":{part[0].first},' if cursor == 0 or part[0].first else ""
        text = f'{{"type":"log",{first}"rows":[{rows}],"paths":[{paths}],"events":[{events}]}}'
        return text, end

"""A source of made-up rows, by a pool: what runs on the nodes of a cluster in tests."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from support.stored_rows import make_row
from trundle.evaluation.pool import Done, Pool
from trundle.evaluation.row import Row


class MakeRow:
    """Gives the row of an index, after some time."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds

    def setup(self) -> None:
        pass

    def __call__(self, index: int, note: Callable[[Mapping[str, Any]], None]) -> Row:
        time.sleep(self._seconds)
        return make_row(index)


class PooledRows:
    """Rows of a pool."""

    def __init__(self, workers: int, seconds: float = 0.0) -> None:
        self._pool = Pool(MakeRow(seconds), workers=workers, deadline_s=60, memory_mb=None)

    def rows(self, indices: Iterable[int]) -> Iterator[Row]:
        for done in self._pool.run(indices):
            assert isinstance(done, Done), done
            yield done.value

    def close(self) -> None:
        self._pool.close()

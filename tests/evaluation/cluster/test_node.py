"""What a node of a cluster does, without Ray."""

from pathlib import Path

import pytest

from support.pooled_rows import PooledRows
from support.stored_rows import make_row, open_store, read_rows, write_rows
from trundle.errors import OutputError
from trundle.evaluation.cluster.node import Node
from trundle.evaluation.store import code_versions


def test_a_node_writes_the_rows_of_a_shard_as_a_part_and_gives_counts(tmp_path: Path) -> None:
    open_store(tmp_path).close()
    source = PooledRows(1)
    nodes = [Node(lambda workers: source, str(tmp_path), name, 1) for name in ("a", "b")]
    assert nodes[0].start(None, ["pytest"]) == code_versions(["pytest"])
    assert nodes[0].run(range(4)).outcomes == {"arrived": 3, "crashed": 1}
    assert nodes[1].run(range(3, 6)).episodes == 3  # One episode is run twice, as after the loss of a node.
    assert nodes[0].run([]).episodes == 0
    source.close()
    assert len(list((tmp_path / "parts").iterdir())) == 2
    assert read_rows(tmp_path) == [make_row(index) for index in range(6)]


def test_a_node_that_does_not_share_the_folder_says_so(tmp_path: Path) -> None:
    node = Node(PooledRows, str(tmp_path), "a", 1)
    with pytest.raises(OutputError, match=r"is not the same folder here; .* \(s3://bucket/folder\)"):
        node.start("written-by-the-driver", ())


class UntilLate:
    """A source that ends before its last episode, where it is to end at all."""

    def rows(self, indices, *, until=None):
        for index in list(indices)[: None if until is None else -1]:
            yield make_row(index, outcome="error" if index == 5 else "arrived")

    def in_flight_s(self):
        return (3.0,)

    def close(self):
        pass


def test_a_shard_whose_time_is_over_keeps_its_rows_and_says_what_had_begun(tmp_path):
    write_rows(tmp_path, range(0))
    node = Node(lambda workers: UntilLate(), str(tmp_path), "n", 1)
    done = node.run([4, 5, 6], 1.0)
    assert (done.episodes, done.errors, done.in_flight_s) == (2, (5,), (3.0,))
    assert node.run([7, 8]).in_flight_s == ()
    assert [row.index for row in read_rows(tmp_path)] == [4, 5, 7, 8]

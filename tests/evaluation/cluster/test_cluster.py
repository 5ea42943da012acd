"""An evaluation on several nodes gives the rows of a local one, also where one is lost."""

from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from support.pooled_rows import PooledRows
from support.stored_rows import VERSIONS, make_row, open_store, read_rows
from trundle.evaluation.cluster import ClusterError, run_on_cluster
from trundle.evaluation.store import code_versions
from trundle.evaluation.store.remote import RemoteFolder, staged

pytestmark = pytest.mark.ray


def run(folder: Any, indices: Any, cluster: Any, **given: Any) -> Any:
    values = {"address": cluster.address, "versions": code_versions(), "shard": 10, "workers": 1, **given}
    seconds = values.pop("seconds", 0.0)
    return run_on_cluster(partial(PooledRows, seconds=seconds), indices, out=folder, **values)


def test_a_node_that_is_killed_midway_loses_no_row(pair: Any, tmp_path: Path) -> None:
    outcomes: Counter[str] = Counter()
    with open_store(tmp_path) as store:
        for done in run(tmp_path, store.pending(()), pair, seconds=0.1):
            if not outcomes:
                pair.remove_node(pair.first, allow_graceful=False)
            outcomes.update(done.outcomes)
    assert outcomes == Counter(make_row(index).outcome for index in range(100))
    assert read_rows(tmp_path) == [make_row(index) for index in range(100)]
    with open_store(tmp_path) as store:
        assert list(store.pending([make_row(index).id for index in range(100)])) == []


def test_an_evaluation_that_was_stopped_continues(single: Any, tmp_path: Path) -> None:
    ids = [make_row(index).id for index in range(100)]
    with open_store(tmp_path) as store:
        running = run(tmp_path, store.pending(()), single)
        next(running)
        next(running)
        running.close()
    with open_store(tmp_path) as store:
        left = store.pending(ids)
        assert 0 < len(left) <= 80
        assert sum(done.episodes for done in run(tmp_path, left, single)) == len(left)
    assert read_rows(tmp_path) == [make_row(index) for index in range(100)]


def test_nodes_write_into_an_object_store(single: Any, tmp_path: Path) -> None:
    uri = (tmp_path / "bucket" / "e").as_uri()
    with staged(uri) as copy:
        with open_store(copy.folder) as store:
            copy.push()
            assert sum(done.episodes for done in run(uri, store.pending(()), single)) == 100
        copy.pull()
        assert read_rows(copy.folder) == [make_row(index) for index in range(100)]
    assert {"evaluation.json", "suite.yaml"} <= set(RemoteFolder(uri).list())
    with staged(uri) as copy, open_store(copy.folder) as store:
        assert list(store.pending([make_row(index).id for index in range(100)])) == []


def test_a_node_with_other_code_is_refused(single: Any, tmp_path: Path) -> None:
    with open_store(tmp_path), pytest.raises(ClusterError, match=r"the node .* runs other code \(.*numpy.*--mixed"):
        list(run(tmp_path, range(3), single, versions=VERSIONS))


def test_what_fails_on_a_node_is_said_once(single: Any, tmp_path: Path) -> None:
    with pytest.raises(ClusterError, match=r"on the node .*: cannot write .*parts"):
        list(run(tmp_path, range(3), single))


def test_auto_starts_a_cluster_on_this_machine(loopback: None, tmp_path: Path) -> None:
    with open_store(tmp_path) as store:
        done = run_on_cluster(PooledRows, store.pending(()), out=tmp_path, address="auto", versions=code_versions())
        assert sum(each.episodes for each in done) == 100
    assert len(read_rows(tmp_path)) == 100

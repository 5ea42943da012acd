"""The folder of an evaluation: no row is lost or there twice, whatever stops the writer."""

import importlib.util
import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from support.stored_rows import SUITE, VERSIONS, make_row, open_store, read_rows, write_rows
from trundle.errors import InputError, MissingExtraError, OutputError
from trundle.evaluation.report.summary import summarise
from trundle.evaluation.statistics.comparison import compare
from trundle.evaluation.statistics.table import Table as StatisticsTable
from trundle.evaluation.store import Store, code_versions, parts, row_encoding
from trundle.evaluation.store.folder import describe_differences

KILL_AT_EVERY_STEP = """
import shutil, sys
from pathlib import Path
from support.stored_rows import make_row, open_store, read_rows, write_rows
from support.killed import kill_at_every_step

root = Path(sys.argv[1])
folder = root / "e"
said = root / "said"
import duckdb  # before the forks

write_rows(root / "half", range(2))
with open(root / "half" / "journal.jsonl", "ab") as journal:
    journal.write(b'{"id": "to')

def prepare():
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(root / "half", folder)
    said.write_text("")

def write():
    with open(said, "w", buffering=1) as stream, open_store(folder, part_rows=2) as store:
        for index in range(2, 5):
            store.append(make_row(index))
            stream.write(f"{index}\\n")

def check(step):
    last = max([1, *map(int, said.read_text().split())])
    with open_store(folder, part_rows=100) as store:
        count = len(store.done)
        assert last < count <= last + 2, (step, count, last)
    assert read_rows(folder) == [make_row(index) for index in range(count)], step
    assert not [*folder.glob(".*"), *(folder / "parts").glob(".*")], step

print(kill_at_every_step(prepare, write, check))
"""


def test_rows_are_there_as_soon_as_they_are_appended_and_come_back_by_index(tmp_path: Path) -> None:
    with open_store(tmp_path / "e") as store:
        for index in (3, 1, 0, 2):
            store.append(make_row(index))
            store.append(make_row(index))
            lines = (tmp_path / "e" / "journal.jsonl").read_text().splitlines()
            assert json.loads(lines[-1])["index"] == index
        assert len(lines) == 4
        assert read_rows(tmp_path / "e") == [make_row(index) for index in range(4)]
    assert (tmp_path / "e" / "journal.jsonl").read_bytes() == b""
    assert len(list((tmp_path / "e" / "parts").glob("*.parquet"))) == 1
    assert read_rows(tmp_path / "e") == [make_row(index) for index in range(4)]


def test_parts_are_made_while_rows_come_in(tmp_path: Path) -> None:
    with open_store(tmp_path) as store:
        for index in range(95):
            store.append(make_row(index))
        assert len(list((tmp_path / "parts").glob("*.parquet"))) == 9
        assert len((tmp_path / "journal.jsonl").read_bytes().splitlines()) == 5
        assert read_rows(tmp_path) == [make_row(index) for index in range(95)]
    assert read_rows(tmp_path) == [make_row(index) for index in range(95)]


@pytest.mark.slow
def test_a_kill_at_any_step_neither_loses_nor_doubles_a_row(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", KILL_AT_EVERY_STEP, str(tmp_path)],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 20


def test_a_store_continues_where_the_last_ended(tmp_path: Path) -> None:
    ids = [make_row(index).id for index in range(100)]
    with open_store(tmp_path) as store:
        assert list(store.pending(iter(()))) == list(range(100)), "a new one needs no ids"
    write_rows(tmp_path, range(7))
    with open_store(tmp_path) as store:
        assert list(store.pending(ids)) == list(range(7, 100))
        assert make_row(3).id in store.done
        assert make_row(7).id not in store.done


def test_rows_of_a_changed_suite_are_kept_and_numbered_as_in_it(tmp_path: Path) -> None:
    write_rows(tmp_path, range(12))
    changed = [make_row(index).id for index in (40, 8, 9, 2, 41)]
    with open_store(tmp_path, suite_text=SUITE + "planners: [auto]\n", total=5) as store:
        assert list(store.pending(changed)) == [0, 4]
        store.append(replace(make_row(41), index=4))
        assert [row.index for row in read_rows(tmp_path)] == [1, 2, 3, 4]
    assert [row.id for row in read_rows(tmp_path)] == changed[1:]
    with open_store(tmp_path) as store:  # The suite as it was: all its rows are valid again.
        assert list(store.pending([make_row(index).id for index in range(12)])) == []
    assert read_rows(tmp_path) == [make_row(index) for index in range(12)]


def test_an_id_that_the_suite_has_twice_is_run_once(tmp_path: Path) -> None:
    write_rows(tmp_path, range(1))
    with open_store(tmp_path) as store:
        assert list(store.pending([make_row(index).id for index in (0, 5, 5, 0)])) == [1]


def test_a_second_evaluation_in_the_folder_is_refused_with_the_process(tmp_path: Path) -> None:
    with (
        open_store(tmp_path),
        pytest.raises(OutputError, match=rf"another evaluation \(process {os.getpid()}\) .*-o"),
    ):
        open_store(tmp_path)
    open_store(tmp_path).close()


def test_the_lock_of_an_evaluation_that_was_killed_holds_nobody_up(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys\nfrom pathlib import Path\nfrom support.stored_rows import open_store\n"
        "open_store(Path(sys.argv[1]))\nos.kill(os.getpid(), signal.SIGKILL)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run([sys.executable, "-c", code, str(tmp_path)], env=environment, check=False)
    assert done.returncode == -signal.SIGKILL
    open_store(tmp_path).close()


def test_folders_of_other_things_are_refused_and_stay(tmp_path: Path) -> None:
    for name, message in (("episode.json", "folder of a run"), ("suite.yaml", r"replace \(suite.yaml\)")):
        folder = tmp_path / name.split(".")[0]
        folder.mkdir()
        (folder / name).write_text("mine")
        with pytest.raises(OutputError, match=rf"{message}.*-o"):
            open_store(folder)
        with pytest.raises(OutputError, match=message):
            open_store(folder, overwrite=True)
        assert [path.name for path in folder.iterdir()] == [name]
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"cannot write to the folder .*-o"):
        open_store(tmp_path / "file" / "below")


def test_another_suite_is_refused_with_what_differs(tmp_path: Path) -> None:
    write_rows(tmp_path, range(3))
    with pytest.raises(OutputError, match=r"'s' with 100 .*'t' \(they differ in worlds\).*-o.*--overwrite.*name: s"):
        open_store(tmp_path, name="t", suite_text="name: t\nworlds: [b]\n")
    assert len(read_rows(tmp_path)) == 3
    with open_store(tmp_path, name="t", suite_text="name: t\nworlds: [b]\n", overwrite=True) as store:
        assert len(store.done) == 0
    assert read_rows(tmp_path) == []


def test_other_code_is_refused_unless_mixed(tmp_path: Path) -> None:
    write_rows(tmp_path, range(3))
    other = {**VERSIONS, "numpy": "2.1", "sources": "cc", "commit": "2" * 40}
    with pytest.raises(
        OutputError, match=r"numpy 2\.0 → 2\.1; trundle's sources, commit 1{10} → 2{10}.*-o.*--overwrite.*--mixed"
    ):
        open_store(tmp_path, versions=other)
    with open_store(tmp_path, versions=other, mixed=True) as store:
        assert len(store.done) == 3
    manifest = json.loads((tmp_path / "evaluation.json").read_text())
    assert manifest["versions"] == other
    assert manifest["earlier_versions"] == [VERSIONS]
    open_store(tmp_path, versions={**other, "commit": "3" * 40}).close()  # Another commit of the same sources.


def test_the_code_is_known_by_its_versions_and_sources() -> None:
    versions = code_versions(["pytest", "no-such-package"])
    assert {"trundle", "python", "numpy", "mujoco", "sources", "kernels", "pytest"} <= set(versions)
    assert "no-such-package" not in versions
    assert versions == code_versions(["pytest"])
    assert describe_differences(versions, versions) == ""
    assert describe_differences(versions, {**versions, "sources": "other"}) == "trundle's sources"


def test_a_damaged_manifest_is_named(tmp_path: Path) -> None:
    write_rows(tmp_path, range(3))
    (tmp_path / "evaluation.json").write_text('{"name": "s"}')
    with pytest.raises(InputError, match=r"evaluation\.json: it is damaged"):
        open_store(tmp_path)


def test_a_new_folder_is_made_where_none_is_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with open_store(None) as store:
        assert store.folder.parent == Path("runs")
        assert store.folder.name.endswith("-s")


def test_a_full_disk_stops_with_one_error_and_tears_nothing(tmp_path: Path) -> None:
    code = """
import resource, sys
from pathlib import Path
from support.stored_rows import make_row, open_store
from trundle.errors import OutputError
store = open_store(Path(sys.argv[1]), part_rows=1000)
resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))
messages = []
try:
    with store:
        for index in range(100):
            store.append(make_row(index))
except OutputError as error:
    print(index, error)
"""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run(
        [sys.executable, "-B", "-c", code, str(tmp_path)], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    count = int(done.stdout.split()[0])
    assert 0 < count < 100
    assert f"{count} rows are safe" in done.stdout
    assert "same command" in done.stdout
    with open_store(tmp_path) as store:
        assert store.damage == ()
        assert len(store.done) == count
        assert len(read_rows(tmp_path)) == count


def test_without_duckdb_the_journal_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    find = importlib.util.find_spec
    with monkeypatch.context() as without:
        without.setattr(
            "trundle.evaluation.store.parts.find_spec", lambda name: None if name == "duckdb" else find(name)
        )
        without.setitem(sys.modules, "duckdb", None)
        write_rows(tmp_path, range(25))
        assert len((tmp_path / "journal.jsonl").read_bytes().splitlines()) == 25
        assert list((tmp_path / "parts").iterdir()) == []
        assert read_rows(tmp_path) == [make_row(index) for index in range(25)]
        with open_store(tmp_path) as store:
            assert list(store.pending([make_row(index).id for index in (3, 50)])) == [1]
        assert [(row.id, row.index) for row in read_rows(tmp_path)] == [(make_row(3).id, 0)]
    write_rows(tmp_path, range(30))  # With it, the journal becomes a part.
    assert (tmp_path / "journal.jsonl").read_bytes() == b""
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "duckdb", None)
        with pytest.raises(MissingExtraError, match=r"\[evaluate\]"):
            open_store(tmp_path)


def test_figures_that_are_not_finite_survive(tmp_path: Path) -> None:
    row = make_row(1, time_s=float("inf"), trail=(float("inf"), 1.25))
    with open_store(tmp_path) as store:
        store.append(row)
        assert read_rows(tmp_path) == [row]
    assert read_rows(tmp_path) == [row]
    assert isinstance(store, Store)


def test_seeds_have_up_to_64_bits(tmp_path: Path) -> None:
    row = make_row(1, seed=2**64 - 1)
    with open_store(tmp_path) as store:
        store.append(row)
        with pytest.raises(InputError, match="64 bits"):
            store.append(make_row(2, seed=2**64))
    assert read_rows(tmp_path) == [row]


def test_a_folder_from_before_the_figures_of_sensing_is_read_and_continued(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its parts and its journal lack the columns; rows written since have them."""
    located = ("position_error_m", "localization_error_m", "localization_error_p95_m", "lost_s")
    new = ("standing_contacts", "unseen_contacts", *located, "monitor_stops")
    with monkeypatch.context() as before:
        older = {name: kind for name, kind in row_encoding.SQL_TYPES.items() if name not in new}
        before.setattr(parts, "SQL_TYPES", older)
        write_rows(tmp_path / "e", range(6), part_rows=4)
    assert list((tmp_path / "e" / "parts").glob("*.parquet"))
    line = json.loads(row_encoding.encode_row(make_row(6)))
    old_line = json.dumps({name: value for name, value in line.items() if name not in new})
    (tmp_path / "e" / "journal.jsonl").write_text(f"{old_line}\n")
    since = dict.fromkeys(new, 3)
    with open_store(tmp_path / "e", part_rows=100) as store:
        store.append(make_row(7, **since))
    assert read_rows(tmp_path / "e") == [*(make_row(index) for index in range(7)), make_row(7, **since)]
    table = StatisticsTable.of(read_rows(tmp_path / "e"))
    assert [bool(one) for one in np.isnan(table.numbers["position_error_m"])] == [True] * 7 + [False]
    assert summarise(table)["medians"]["monitor_stops"] == 3.0
    assert not compare(StatisticsTable.of(read_rows(tmp_path / "e")[:6]), table).worse

"""Reading an evaluation's folder: in SQL, as columns, and one episode by the start of its id."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from support.stored_rows import SUITE, VERSIONS, make_row, open_store, write_rows
from trundle.errors import InputError, MissingExtraError
from trundle.evaluation.store import Results


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Rows 0 to 32, of which the last three are in the journal."""
    path = tmp_path_factory.mktemp("evaluation") / "e"
    with open_store(path) as store:
        for index in range(33):
            store.append(make_row(index))
        held = (path / "journal.jsonl").read_bytes()
    (path / "parts" / sorted(path.name for path in (path / "parts").iterdir())[-1]).unlink()
    (path / "journal.jsonl").write_bytes(held)
    return path


def without_duckdb(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trundle.evaluation.store.parts.find_spec", lambda name: None)
    monkeypatch.setitem(sys.modules, "duckdb", None)


@pytest.fixture(params=[True, False], ids=["DuckDB", "journal"])
def results(request: pytest.FixtureRequest, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Results:
    """The same rows in parts and journal, or in the journal alone and without DuckDB."""
    if request.param:
        return Results.open(folder)
    without_duckdb(monkeypatch)
    write_rows(tmp_path, range(33))
    return Results.open(tmp_path)


def test_it_tells_what_was_evaluated(results: Results) -> None:
    assert (results.name, results.total, results.suite_text, results.versions) == ("s", 100, SUITE, VERSIONS)
    assert results.earlier_versions == ()
    assert len(results) == 33
    assert results.damage == ()


def test_columns_have_nan_or_none_where_a_row_has_no_value(results: Results) -> None:
    rows = [make_row(index) for index in range(33)]
    found = results.columns("time_s", "index", "contacts", "outcome", "error", "seed", "trail", "vary")
    assert list(found) == ["time_s", "index", "contacts", "outcome", "error", "seed", "trail", "vary"]
    np.testing.assert_array_equal(found["time_s"], [np.nan if row.time_s is None else row.time_s for row in rows])
    np.testing.assert_array_equal(found["contacts"], [np.nan if row.contacts is None else row.contacts for row in rows])
    assert found["index"].dtype == np.int64
    assert found["seed"].tolist() == found["index"].tolist() == list(range(33))
    assert found["outcome"].tolist() == [row.outcome for row in rows]
    assert found["error"].tolist() == [None] * 33
    assert [tuple(trail) for trail in found["trail"]] == [row.trail for row in rows]
    assert found["vary"].tolist() == [row.vary for row in rows]
    with pytest.raises(InputError, match=r"no column nonsense; there are: id, mission"):
        results.columns("nonsense")


def test_an_episode_is_found_by_the_start_of_its_id(results: Results) -> None:
    wanted = make_row(7)
    assert results.find(wanted.id) == results.find(wanted.id[:8].upper()) == wanted
    with pytest.raises(InputError, match=r"no episode 'zz' among its 33; .*evaluate show"):
        results.find("zz")
    with pytest.raises(InputError, match="no episode ''"):
        results.find("")
    starts = [make_row(index).id[0] for index in range(33)]
    several = max(set(starts), key=starts.count)
    with pytest.raises(InputError, match=rf"several episodes start with '{several}': {several}.*more digits"):
        results.find(several)


def test_episodes_are_asked_in_sql(folder: Path) -> None:
    results = Results.open(folder)
    found = results.query("SELECT outcome, count(*) AS n, avg(vary_friction) AS mu FROM episodes GROUP BY 1 ORDER BY 1")
    assert found["n"].tolist() == [24, 9]
    frictions = [row.vary["friction"] for row in map(make_row, range(33)) if row.vary is not None]
    assert found["mu"][0] == pytest.approx(np.mean(frictions))
    assert results.query("SELECT list_max(trail) AS x FROM episodes WHERE seed = 9")["x"][0] == max(make_row(9).trail)
    with pytest.raises(InputError, match=r"cannot be run: .*outcom"):
        results.query("SELECT outcom FROM episodes")


def test_a_frame_has_a_column_for_each_thing_that_varies(folder: Path) -> None:
    frame = Results.open(folder).to_pandas()
    assert frame["index"].tolist() == list(range(33))
    assert {"id", "error", "trail", "vary_friction", "vary_mass kg"} <= set(frame.columns)
    assert frame["vary_friction"].isna().sum() == 17


def test_without_duckdb_or_pandas_the_install_line_is_given(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "pandas", None)
        with pytest.raises(MissingExtraError, match=r"pandas.*\[evaluate\]"):
            Results.open(folder).to_pandas()
    without_duckdb(monkeypatch)
    with pytest.raises(MissingExtraError, match=r"DuckDB.*\[evaluate\]"):
        Results.open(folder)
    write_rows(tmp_path, range(3))
    with pytest.raises(MissingExtraError, match=r"DuckDB.*\[evaluate\]"):
        Results.open(tmp_path).to_pandas()


def test_an_empty_evaluation_has_all_columns(tmp_path: Path) -> None:
    open_store(tmp_path).close()
    results = Results.open(tmp_path)
    assert len(results) == 0
    assert list(results.rows()) == []
    assert len(results.to_pandas()) == 0
    assert results.columns("time_s", "trail")["time_s"].shape == (0,)


def test_a_row_in_two_parts_is_read_once(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "e")
    part = min((tmp_path / "e" / "parts").iterdir())
    shutil.copy(part, part.with_name(part.name.replace("000001-", "000009-again-")))
    assert list(Results.open(tmp_path / "e").rows()) == [make_row(index) for index in range(33)]


def test_other_folders_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        Results.open(tmp_path / "none")
    with pytest.raises(InputError, match=r"no evaluation\.json in it"):
        Results.open(tmp_path)
    (tmp_path / "episode.json").write_text("{}")
    with pytest.raises(InputError, match=r"folder of a run.*trundle compare.*trundle run --from"):
        Results.open(tmp_path)
    with pytest.raises(InputError, match="not a folder"):
        Results.open(tmp_path / "episode.json")

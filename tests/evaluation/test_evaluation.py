"""An evaluation as a context manager: what it holds, and what is left of it afterwards."""

import tempfile
from pathlib import Path

import pytest

import trundle
from support.stored_rows import write_rows
from trundle.errors import InputError
from trundle.evaluation import Evaluation


@pytest.fixture
def copies(tmp_path, monkeypatch):
    """Where copies of folders in object stores are made."""
    folder = tmp_path / "copies"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.fixture
def stored(tmp_path):
    """An evaluation in an object store."""
    pytest.importorskip("pyarrow")
    write_rows(tmp_path / "stored", range(4))
    return (tmp_path / "stored").as_uri()


def test_the_copy_of_an_evaluation_is_gone_after_its_block(stored, copies):
    with Evaluation(stored) as evaluation:
        assert len(evaluation) == 4
        assert list(copies.iterdir())
    assert not list(copies.iterdir())


def test_it_is_gone_after_an_exception_in_the_block_too(stored, copies):
    with pytest.raises(ZeroDivisionError), Evaluation(stored):
        raise ZeroDivisionError
    assert not list(copies.iterdir())


def test_no_copy_is_left_of_what_is_compared_or_cannot_be_read(stored, copies, tmp_path):
    with Evaluation(stored) as evaluation:
        before = len(list(copies.iterdir()))
        evaluation.compare(stored)
        assert len(list(copies.iterdir())) == before
    (tmp_path / "stored" / "evaluation.json").write_text("{")
    with pytest.raises(InputError) as refused:
        Evaluation(stored)
    assert not list(copies.iterdir()), refused.value


@pytest.mark.parametrize(
    "use",
    [
        len,
        lambda evaluation: list(evaluation.rows()),
        lambda evaluation: evaluation.success,
        lambda evaluation: evaluation.to_pandas(),
        lambda evaluation: evaluation.summary(),
        lambda evaluation: evaluation.scenario_of("a"),
        lambda evaluation: evaluation.write_report(),
    ],
)
def test_a_closed_evaluation_says_so(use, tmp_path):
    write_rows(tmp_path, range(4))
    evaluation = Evaluation(tmp_path)
    evaluation.close()
    evaluation.close()
    with pytest.raises(InputError, match="is closed: read its rows inside the with block, or before close"):
        use(evaluation)
    assert repr(evaluation) == f"Evaluation({str(tmp_path)!r}, closed)"


def test_what_was_read_stays_after_the_block(tmp_path):
    write_rows(tmp_path, range(4))
    with Evaluation(tmp_path) as evaluation:
        success, outcomes = evaluation.success, evaluation.outcomes
    assert (evaluation.success, evaluation.outcomes) == (success, outcomes)


def test_evaluate_gives_one_for_a_block(room, tmp_path):
    room.save(tmp_path / "room.yaml")
    suite = {"maps": tmp_path / "room.yaml", "backends": "kinematic", "seeds": 1}
    with trundle.evaluate(suite, workers=1, out=tmp_path / "out") as evaluation:
        assert len(evaluation) == 1
    assert Path(evaluation.folder) == tmp_path / "out"

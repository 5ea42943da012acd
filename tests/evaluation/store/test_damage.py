"""Rows of a folder that was damaged: reported once, put aside, run again."""

import json
import re
from pathlib import Path

import pytest

from support.stored_rows import make_row, open_store, read_rows, write_rows
from trundle.errors import InputError
from trundle.evaluation.store import parts, row_encoding


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spoil", "message", "lost"),
    [
        (lambda part, journal: journal.write_bytes(journal.read_bytes()[:-5]), "journal.jsonl:3: .* cut off", {12}),
        (lambda part, journal: journal.write_bytes(b"\xff\0\n" + journal.read_bytes()), "journal.jsonl:1: ", set()),
        (
            lambda part, journal: journal.write_text(journal.read_text().replace('"time_s":', '"time_s":"x","z":', 1)),
            "journal.jsonl:1: .*time_s is 'x'",
            {10},
        ),
        (lambda part, journal: part.write_bytes(part.read_bytes()[:-9]), "parquet: it is damaged", set(range(10))),
        (
            lambda part, journal: part.write_bytes(part.read_bytes().replace(b"nova_carter", b"nova_certer")),
            "parquet: it is damaged",
            set(range(10)),
        ),
        (lambda part, journal: part.write_bytes(b""), "parquet: it is damaged", set(range(10))),
        (lambda part, journal: part.with_name("mine.parquet").write_text("mine"), "did not write it", set()),
    ],
)
def test_damage_is_reported_once_and_only_what_it_hit_runs_again(tmp_path: Path, spoil, message, lost) -> None:
    store = open_store(tmp_path)
    for index in range(13):
        store.append(make_row(index))
    (part,) = (tmp_path / "parts").glob("*.parquet")
    held = tmp_path.parent / f"{tmp_path.name}-copy"
    held.mkdir()
    (held / "parts").mkdir()
    for name in ("evaluation.json", "suite.yaml", "journal.jsonl", f"parts/{part.name}"):
        (held / name).write_bytes((tmp_path / name).read_bytes())
    store.close()
    spoil(held / "parts" / part.name, held / "journal.jsonl")
    left = [make_row(index) for index in range(13) if index not in lost]
    assert read_rows(held) == left
    with open_store(held, total=13) as store:
        assert len(store.damage) == 1
        assert re.search(message, store.damage[0])
        assert set(store.pending([make_row(index).id for index in range(13)])) == lost
        assert read_rows(held) == left
    with open_store(held) as store:
        assert store.damage == ()
        for index in lost:
            store.append(make_row(index))
    assert read_rows(held) == [make_row(index) for index in range(13)]


DAMAGED = {
    "index": 10**30,
    "seed": -1,
    "contacts": 10**25,
    "time_s": 10**400,
    "trail": [1.0, 2.0, 3.0],
    "vary": {"friction": "low"},
    "world": "\ud800",
    "id": "0x23456789abcdef",
    "mission": "\N{DEGREE SIGN}",
}


def damaged_lines() -> list[bytes]:
    plain = make_row(3).as_dict()
    lines = [json.dumps({**plain, name: value}).encode() for name, value in DAMAGED.items()]
    whole = json.dumps(plain).encode()
    return [
        *lines,
        json.dumps({**plain, "trail": [[1, 2], [3, 4]]}).encode(),
        whole[:-1] + b',"world":"twice"}',
        b"\xef\xbb\xbf" + whole,
        json.dumps(plain).encode("utf-16-le"),
        whole[:-1] + b',"more":"' + b"x" * (5 << 20) + b'"}',
        whole[:-1] + b',"more":' + b"[" * 200_000 + b"]" * 200_000 + b"}",
    ]


@pytest.mark.parametrize("without_duckdb", [False, True])
def test_lines_that_hold_no_row_are_named_put_aside_and_run_again(tmp_path, monkeypatch, without_duckdb):
    if without_duckdb:
        monkeypatch.setattr(parts, "find_spec", lambda _: None)
    open_store(tmp_path).close()
    journal = tmp_path / "journal.jsonl"
    rows = [row_encoding.encode_row(make_row(index)) for index in range(5)]
    damaged = b"".join(line + b"\n" for line in damaged_lines())
    journal.write_bytes(b"".join([*rows[:2], damaged, rows[4]]))
    assert read_rows(tmp_path) == [make_row(index) for index in (0, 1, 4)]
    with open_store(tmp_path, total=5) as store:
        numbers = range(3, 3 + len(damaged_lines()))
        assert [text.split(": ")[0] for text in store.damage] == [f"{journal}:{number}" for number in numbers]
        assert all(
            text.endswith("; its episode runs again, and it is kept in journal.jsonl.damaged") for text in store.damage
        )
        assert list(store.pending([make_row(index).id for index in range(5)])) == [2, 3]
    assert (tmp_path / "journal.jsonl.damaged").read_bytes() == damaged
    with open_store(tmp_path, total=5) as store:
        assert store.damage == ()
        for index in (2, 3):
            store.append(make_row(index))
    assert read_rows(tmp_path) == [make_row(index) for index in range(5)]


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"\x93NUMPY\x01\x00"])
def test_a_damaged_selection_is_named(tmp_path: Path, content: bytes) -> None:
    write_rows(tmp_path, range(3))
    (tmp_path / "selection.npy").write_bytes(content)
    with pytest.raises(InputError, match=r"selection\.npy: it is damaged"):
        read_rows(tmp_path)

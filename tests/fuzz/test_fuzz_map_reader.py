from __future__ import annotations

import random

import pytest

from fuzz import fuzz_map_reader
from trundle.maps.pnm import decode_pnm


def test_thousands_of_damaged_maps_give_a_grid_or_a_map_error(tmp_path):
    assert fuzz_map_reader.run(fuzz_map_reader.Target(tmp_path), seed=1, count=2500) == 2500


def test_the_undamaged_inputs_are_read(tmp_path, monkeypatch):
    # A MapError for these would be swallowed by the target.
    class StrictError(Exception):
        pass

    monkeypatch.setattr(fuzz_map_reader, "MapError", StrictError)
    target = fuzz_map_reader.Target(tmp_path)
    target.read("yaml", fuzz_map_reader.YAML)
    target.read("map", fuzz_map_reader.MOVINGAI_MAP)
    target.read("scen", fuzz_map_reader.MOVINGAI_SCENARIO)
    for image in fuzz_map_reader.IMAGES:
        target.read("image", image)


def test_another_exception_is_found(tmp_path, monkeypatch):
    def fragile(content: bytes, name: str) -> object:
        if len(content) % 7 == 0:
            raise IndexError("planted")
        return decode_pnm(content, name)

    monkeypatch.setattr("trundle.maps.pnm.decode_pnm", fragile)
    with pytest.raises(IndexError, match="planted"):
        fuzz_map_reader.run(fuzz_map_reader.Target(tmp_path), seed=1, count=500)


def test_one_seed_gives_one_sequence():
    first, second = fuzz_map_reader.inputs(7), fuzz_map_reader.inputs(7)
    assert [next(first) for _ in range(50)] == [next(second) for _ in range(50)]
    assert fuzz_map_reader.mutate(b"abc", random.Random(1)) == fuzz_map_reader.mutate(b"abc", random.Random(1))

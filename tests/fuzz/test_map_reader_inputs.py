from __future__ import annotations

import random

from fuzz import fuzz_map_reader


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


def test_one_seed_gives_one_sequence():
    first, second = random.Random(7), random.Random(7)
    for _ in range(50):
        assert fuzz_map_reader.make_input(first) == fuzz_map_reader.make_input(second)

import json
import math
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from trundle.cli.shared import output


class Colour(StrEnum):
    RED = "red"


class Pair(NamedTuple):
    left: float
    right: float


@dataclass(frozen=True)
class Thing:
    pair: Pair
    values: np.ndarray


def test_json_holds_every_kind_of_value(capsys: pytest.CaptureFixture[str]) -> None:
    thing = Thing(Pair(1.0, math.nan), np.array([1.0, math.inf]))
    output.print_json(
        {"thing": thing, "colour": Colour.RED, "path": Path("a/b"), 3: np.int64(4), "flag": np.bool_(True)}
    )
    assert json.loads(capsys.readouterr().out) == {
        "thing": {"pair": {"left": 1.0, "right": None}, "values": [1.0, None]},
        "colour": "red",
        "path": "a/b",
        "3": 4,
        "flag": True,
    }


def test_a_value_without_a_form_is_refused() -> None:
    with pytest.raises(TypeError, match="object cannot be written"):
        output.print_json(object())


def test_columns_line_up(capsys: pytest.CaptureFixture[str]) -> None:
    output.print_table(("name", "x"), [("long name", 1.0), ("a", math.nan), ("b", None)])
    assert capsys.readouterr().out == "name       x\nlong name  1.000\na          -\nb          -\n"


def test_facts_line_up(capsys: pytest.CaptureFixture[str]) -> None:
    output.print_facts({"outcome": "arrived", "time": 1.5})
    assert capsys.readouterr().out == "outcome  arrived\ntime     1.500\n"


def test_quiet_keeps_remarks_back(capsys: pytest.CaptureFixture[str]) -> None:
    output.remark("one", quiet=True)
    output.remark("two", quiet=False)
    streams = capsys.readouterr()
    assert (streams.out, streams.err) == ("", "two\n")

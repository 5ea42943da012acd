"""`Gate`: what an evaluation must fulfil (`--require 'success>=0.99'`), and its verdict."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, UnknownNameError
from trundle.evaluation.statistics.figures import BY_NAME, Figure, write_number, write_share
from trundle.evaluation.statistics.intervals import episodes_to_decide, no_failure_bound, wilson
from trundle.evaluation.statistics.paired_tests import bootstrap_means
from trundle.evaluation.statistics.table import LABELS, Table

_PATTERN = re.compile(
    r"\s*(?P<name>[A-Za-z_]\w*)\s*(?:\[(?P<labels>[^\]]*)\])?\s*(?P<sign>>=|<=)\s*(?P<bound>[^\s<>=]+)\s*"
)
_EVERY = ("contacts", "standing_contacts", "unseen_contacts")
"""Figures that no episode may exceed: an interval of their mean never ends at 0."""
State = Literal["passed", "failed", "undecided"]


@dataclass(frozen=True, slots=True)
class GateResult:
    """The result of a gate.

    Attributes:
        gate: The gate as it was written.
        state: `undecided` where the interval holds the bound: more episodes would tell. A gate that is undecided has
            not passed.
        text: The verdict with its figures.
        more_needed: About how many more episodes would decide, if they go as those so far; 0 where it is decided, None
            where no number would do.
    """

    gate: str
    state: State
    text: str
    more_needed: int | None

    @property
    def passed(self) -> bool:
        """Whether the gate is fulfilled."""
        return self.state == "passed"

    def as_dict(self) -> dict[str, Any]:
        """Return the result as plain values, for JSON."""
        return {
            "gate": self.gate,
            "passed": self.passed,
            "state": self.state,
            "text": self.text,
            "more_needed": self.more_needed,
        }


@dataclass(frozen=True, slots=True)
class Gate:
    """A figure, and the bound that the end of its interval must keep.

    Attributes:
        figure: Name of the figure: `success`, `spl`, `time_s` and so on; see `FIGURES`.
        sign: `>=` compares the low end of the 95 % interval with the bound, `<=` the high end.
        bound: The bound.
        labels: Only episodes with these labels count.
    """

    figure: str
    sign: Literal[">=", "<="]
    bound: float
    labels: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def parse(cls, text: str) -> Gate:
        """Read `success>=0.99`, `time_s<=40` or `success[planner=auto,world=office]>=0.99`.

        Raises:
            InputError: If it is no such requirement; for an unknown figure or label with the nearest that there is.
        """
        found = _PATTERN.fullmatch(text)
        if found is None:
            raise InputError(
                f"cannot read the requirement {text!r}; write a figure, >= or <=, and a number, as in 'success>=0.99' "
                "or 'success[planner=auto]>=0.99'"
            )
        name, sign, bound = found["name"], found["sign"], _read_bound(found["bound"], text)
        if name not in BY_NAME:
            raise UnknownNameError("figure in a requirement", name, BY_NAME)
        labels: dict[str, str] = {}
        for part in filter(None, map(str.strip, (found["labels"] or "").split(","))):
            label, equals, value = (piece.strip() for piece in part.partition("="))
            if label not in (*LABELS, "agent"):
                raise UnknownNameError("label in a requirement", label, (*LABELS, "agent"))
            if not equals:
                raise InputError(f"requirement {text!r}: write {label}=NAME in the brackets")
            labels[label] = value
        if name == "success" and not 0.0 <= bound <= 1.0:
            raise InputError(f"requirement {text!r}: success is a share from 0 to 1; 99 % is 0.99")
        return cls(name, ">=" if sign == ">=" else "<=", bound, labels)

    def __str__(self) -> str:
        within = ",".join(f"{name}={value}" for name, value in self.labels.items())
        return f"{self.figure}{within and f'[{within}]'}{self.sign}{self.bound:g}"

    def check_labels(self, known: Mapping[str, Collection[str]]) -> None:
        """Refuse a label that does not occur, before anything runs.

        Args:
            known: For each label, the names of the suite.

        Raises:
            UnknownNameError: With the nearest name.
        """
        for label, value in self.labels.items():
            if value not in known.get(label, ()):
                raise UnknownNameError(f"{label} in the requirement {str(self)!r}:", value, known.get(label, ()))

    def judge(self, table: Table) -> GateResult:
        """Compare the end of the figure's interval with the bound.

        While no episode has the labels that it names, it is undecided; `check_labels` tells those that are misspelt.
        """
        rows = np.ones(len(table), dtype=bool)
        for label, value in self.labels.items():
            rows &= table.named[label].where(value)
        figure = BY_NAME[self.figure]
        values = figure.values(table)[rows]
        if self.figure == "success":
            return self._judge_share(int(values.sum()), len(values))
        if self.figure in _EVERY:
            return self._judge_every(figure, values)
        return self._judge_mean(figure, values, table.clusters[rows])

    def _judge_share(self, successes: int, n: int) -> GateResult:
        low, high = wilson(successes, n)
        share = successes / n if n else math.nan
        if self.sign == ">=":
            state, more = self._state(low, high), episodes_to_decide(successes, n, self.bound)
            if n == 0:
                more = episodes_to_decide(1, 1, self.bound)
                more = None if more is None else more + 1
        else:
            state, more = self._state(low, high), episodes_to_decide(n - successes, n, 1.0 - self.bound)
        end = low if self.sign == ">=" else high
        measured = "no episode yet" if n == 0 else f"{write_share(share, n)} of {n:,} arrived"
        which = "low" if self.sign == ">=" else "high"
        text = f"{measured}; the {which} end of the 95 % interval is {write_share(end, n)}"
        return self._result(state, text, more)

    def _judge_every(self, figure: Figure, values: npt.NDArray[np.float64]) -> GateResult:
        """Every episode keeps the bound; one that did not end by itself has no value and is a failure of success."""
        known = values[~np.isnan(values)]
        kept = known >= self.bound if self.sign == ">=" else known <= self.bound
        broken = int((~kept).sum())
        if len(known) == 0:
            return self._result("undecided", "no episode yet", 1)
        if broken:
            which = "fewer" if self.sign == ">=" else "more"
            text = f"{broken} of {len(known)} episodes have {which} than {self.bound:g} {figure.text}"
            return self._result("failed", text, 0)
        bound = write_share(no_failure_bound(len(known)), len(known))
        return self._result("passed", f"in all {len(known)} episodes; at 95 %, at most {bound} of missions do not", 0)

    def _judge_mean(
        self, figure: Figure, values: npt.NDArray[np.float64], clusters: npt.NDArray[np.uint64]
    ) -> GateResult:
        (mean,) = bootstrap_means([values], clusters)
        over = " of those that arrived" if figure.arrived else ""
        if mean.n < 2:
            return self._result("undecided", f"too few episodes{over} for an interval", 2 - mean.n)
        low, high = mean.interval
        state = self._state(low, high)
        end, which = (low, "low") if self.sign == ">=" else (high, "high")
        unit = figure.unit and f" {figure.unit}"
        text = (
            f"mean {figure.text}{over} is {write_number(mean.value)}{unit}; the {which} end of the 95 % interval is "
            f"{write_number(end)}{unit}"
        )
        gap = abs(mean.value - self.bound)
        half = abs(mean.value - (low if mean.value >= self.bound else high))
        more = None if gap == 0.0 else max(1, math.ceil(len(values) * ((half / gap) ** 2 - 1.0)))
        return self._result(state, text, more if state == "undecided" else 0)

    def _state(self, low: float, high: float) -> State:
        if self.sign == ">=":
            return "passed" if low >= self.bound else "failed" if high < self.bound else "undecided"
        return "passed" if high <= self.bound else "failed" if low > self.bound else "undecided"

    def _result(self, state: State, text: str, more: int | None) -> GateResult:
        if state == "undecided":
            text += (
                "; no number of episodes would decide: the figure is at the bound"
                if more is None
                else f"; about {more} more {'episode' if more == 1 else 'episodes'} would decide"
            )
        return GateResult(str(self), state, text, 0 if state != "undecided" else more)


def _read_bound(text: str, whole: str) -> float:
    try:
        bound = float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        bound = math.nan
    if not math.isfinite(bound):
        raise InputError(f"requirement {whole!r}: {text!r} is not a number")
    return bound

"""Evaluation: thousands of missions run, judged and compared."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.evaluation.evaluation import Evaluation, evaluate
    from trundle.evaluation.row import Row
    from trundle.evaluation.suite import Suite, maps_suite, suite_names

__all__ = ["Evaluation", "Row", "Suite", "evaluate", "maps_suite", "suite_names"]

__getattr__ = lazy_names(
    __name__,
    {
        "Evaluation": "trundle.evaluation.evaluation",
        "Row": "trundle.evaluation.row",
        "Suite": "trundle.evaluation.suite",
        "evaluate": "trundle.evaluation.evaluation",
        "maps_suite": "trundle.evaluation.suite",
        "suite_names": "trundle.evaluation.suite",
    },
)

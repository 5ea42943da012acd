"""Statistics of an evaluation's rows: intervals, comparisons on the same missions, gates. Pure functions of numbers."""

from trundle.evaluation.statistics.comparison import Comparison, compare, compare_within
from trundle.evaluation.statistics.gates import Gate, GateResult
from trundle.evaluation.statistics.intervals import Interval, no_failure_bound, rank_correlation, wilson
from trundle.evaluation.statistics.paired_tests import holm, mcnemar_exact, paired_bootstrap
from trundle.evaluation.statistics.table import Table

__all__ = [
    "Comparison",
    "Gate",
    "GateResult",
    "Interval",
    "Table",
    "compare",
    "compare_within",
    "holm",
    "mcnemar_exact",
    "no_failure_bound",
    "paired_bootstrap",
    "rank_correlation",
    "wilson",
]

"""Suites: which episodes an evaluation runs."""

from trundle.evaluation.suite.spec import EpisodeSpec
from trundle.evaluation.suite.suite import Suite, suite_names

__all__ = ["EpisodeSpec", "Suite", "suite_names"]

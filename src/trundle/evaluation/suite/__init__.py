"""Suites: which episodes an evaluation runs."""

from trundle.evaluation.suite.identity import EpisodeSpec
from trundle.evaluation.suite.suite import MAPS, Suite, maps_suite, suite_names

__all__ = ["MAPS", "EpisodeSpec", "Suite", "maps_suite", "suite_names"]

"""Suites: which episodes an evaluation runs."""

from trundle.evaluation.suite.maps import maps_suite
from trundle.evaluation.suite.spec import EpisodeSpec
from trundle.evaluation.suite.suite import MAPS, Suite, suite_names

__all__ = ["MAPS", "EpisodeSpec", "Suite", "maps_suite", "suite_names"]

"""One episode of a suite, from its number to its row."""

from trundle.evaluation.episode.task import EpisodeTask

__all__ = ["EpisodeTask"]

"""One episode of a suite, from its number to its row."""

from trundle.evaluation.episode.task import EpisodeTask, facts_of, parts_of

__all__ = ["EpisodeTask", "facts_of", "parts_of"]

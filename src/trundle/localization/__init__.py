"""Localizers: where a robot believes to be, from what it observes."""

from trundle.localization.localizer import Localizer, LocalizerLike, create_localizer, localizer_names

__all__ = ["Localizer", "LocalizerLike", "create_localizer", "localizer_names"]

"""Localizers: where a robot believes to be, from what it observes."""

from trundle.localization.localizer import Localizer, create_localizer, localizer_names

__all__ = ["Localizer", "create_localizer", "localizer_names"]

"""`mppi`: model predictive path integral control."""

from trundle.control.mppi.controller import MppiController
from trundle.control.mppi.mppi_settings import MppiSettings

__all__ = ["MppiController", "MppiSettings"]

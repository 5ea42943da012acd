"""`amcl`: adaptive Monte Carlo localisation, refined by scan matching."""

from trundle.localization.amcl.amcl_localizer import AmclLocalizer
from trundle.localization.amcl.amcl_settings import AmclSettings

__all__ = ["AmclLocalizer", "AmclSettings"]

"""Nav2's parameter files as settings of a scenario, and the other way round; no ROS is needed."""

from trundle.nav2.export import Nav2Export, export_nav2
from trundle.nav2.notes import Remark, describe_remarks
from trundle.nav2.reading import Nav2Settings, read_nav2_params

__all__ = ["Nav2Export", "Nav2Settings", "Remark", "describe_remarks", "export_nav2", "read_nav2_params"]

"""Nav2's parameter files as settings of a scenario, and the other way round; no ROS is needed."""

from trundle.nav2.reading.translation import Nav2Settings, read_nav2_params
from trundle.nav2.remarks import Remark, describe_remarks

__all__ = ["Nav2Settings", "Remark", "describe_remarks", "read_nav2_params"]

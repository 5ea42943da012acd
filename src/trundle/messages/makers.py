"""`MessageMaker`: ROS messages from trundle's values; clouds of particles, whose type rosbags lacks; `scan_topic`."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.messages.codec import STAMPED_COMMANDS, Codec
from trundle.messages.readers import DIAGNOSIS
from trundle.observation import Estimate, Scan, describe_state
from trundle.robots import Robot
from trundle.sim.state import MoverState

_MARKER_RED, _MARKER_GREEN, _MARKER_BLUE = 0.85, 0.33, 0.1
_LINE_WIDTH_M = 0.05

POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"

_LEVELS = {"localized": 0, "ambiguous": 1, "lost": 2}
"""OK, WARN and ERROR of diagnostic_msgs/DiagnosticStatus."""


def cost_values() -> npt.NDArray[np.int8]:
    """Return what each of Nav2's costs, 0 to 255, is in a nav_msgs/OccupancyGrid, as Costmap2DPublisher writes it."""
    table = np.zeros(256, dtype=np.int8)
    costs = np.arange(1, 253)
    table[1:253] = 1 + (97 * (costs - 1)) // 251
    table[253], table[254], table[255] = 99, 100, -1
    return table


def covariance_of(covariance: FloatArray) -> FloatArray:
    """Write a covariance of (x, y, yaw), shape (3, 3), as that of a PoseWithCovariance, shape (36,)."""
    whole = np.zeros((6, 6))
    whole[np.ix_((0, 1, 5), (0, 1, 5))] = covariance
    return whole.ravel()


def scan_topic(lidar: str, robot: Robot) -> str:
    """Return the topic of a lidar: /scan if it is the robot's only one, else /<its name>/scan."""
    return "/scan" if list(robot.lidars) == [lidar] else f"/{lidar}/scan"


class MessageMaker:
    """Makes messages of a codec's distribution; times are in seconds, and become stamps.

    Args:
        codec: The codec of the distribution.
    """

    def __init__(self, codec: Codec) -> None:
        self.codec = codec
        kind = codec.kind
        self._time, self._header = kind("builtin_interfaces/msg/Time"), kind("std_msgs/msg/Header")
        self._point, self._quaternion = kind("geometry_msgs/msg/Point"), kind("geometry_msgs/msg/Quaternion")
        self._vector, self._pose = kind("geometry_msgs/msg/Vector3"), kind("geometry_msgs/msg/Pose")
        self._transform = kind("geometry_msgs/msg/Transform")
        self._stamped_transform = kind("geometry_msgs/msg/TransformStamped")
        self._stamped_pose, self._twist = kind("geometry_msgs/msg/PoseStamped"), kind("geometry_msgs/msg/Twist")
        self._no_covariance = np.zeros(36)
        self._cost_values = cost_values()
        self._outlines: dict[tuple[tuple[float, float], ...], list[Any]] = {}

    @property
    def command_type(self) -> str:
        """Type of /cmd_vel in this distribution: Twist, or TwistStamped as Nav2 sends by default from Kilted on."""
        stamped = self.codec.distro in STAMPED_COMMANDS
        return "geometry_msgs/msg/TwistStamped" if stamped else "geometry_msgs/msg/Twist"

    # Parts of messages ----------------------------------------------------------------------------------------------

    def stamp(self, time: float) -> Any:
        """Make a time [s] as builtin_interfaces/Time."""
        seconds, nanoseconds = divmod(round(time * 1e9), 1_000_000_000)
        return self._time(sec=seconds, nanosec=nanoseconds)

    def header(self, time: float, frame: str) -> Any:
        """Make a std_msgs/Header."""
        return self._header(stamp=self.stamp(time), frame_id=frame)

    def pose(self, pose: Pose2D, z: float = 0.0) -> Any:
        """Make a geometry_msgs/Pose."""
        return self._pose(position=self._point(pose.x, pose.y, z), orientation=self._turn(pose.yaw))

    def twist(self, twist: Twist2D) -> Any:
        """Make a geometry_msgs/Twist."""
        return self._twist(linear=self._vector(twist.v, 0.0, 0.0), angular=self._vector(0.0, 0.0, twist.w))

    def _turn(self, yaw: float) -> Any:
        return self._quaternion(x=0.0, y=0.0, z=math.sin(0.5 * yaw), w=math.cos(0.5 * yaw))

    # Messages -------------------------------------------------------------------------------------------------------

    def clock(self, time: float) -> Any:
        """Make a rosgraph_msgs/Clock."""
        return self.codec.make("rosgraph_msgs/msg/Clock", clock=self.stamp(time))

    def transform(self, time: float, parent: str, child: str, pose: Pose2D, z: float = 0.0) -> Any:
        """Make a geometry_msgs/TransformStamped: the pose of the child frame in the parent frame."""
        return self._stamped_transform(
            header=self.header(time, parent),
            child_frame_id=child,
            transform=self._transform(
                translation=self._vector(pose.x, pose.y, z),
                rotation=self._turn(pose.yaw),
            ),
        )

    def transforms(self, transforms: Sequence[Any]) -> Any:
        """Make a tf2_msgs/TFMessage."""
        return self.codec.make("tf2_msgs/msg/TFMessage", transforms=list(transforms))

    def odometry(self, time: float, frame: str, child: str, pose: Pose2D, twist: Twist2D) -> Any:
        """Make a nav_msgs/Odometry, whose covariances are zero: not known."""
        kind = self.codec.kind
        return self.codec.make(
            "nav_msgs/msg/Odometry",
            header=self.header(time, frame),
            child_frame_id=child,
            pose=kind("geometry_msgs/msg/PoseWithCovariance")(pose=self.pose(pose), covariance=self._no_covariance),
            twist=kind("geometry_msgs/msg/TwistWithCovariance")(
                twist=self.twist(twist), covariance=self._no_covariance
            ),
        )

    def scan(self, scan: Scan, frame: str, *, range_step: float = 0.0) -> Any:
        """Make a sensor_msgs/LaserScan; its beams are taken to be evenly spaced, as every planar lidar's are.

        Args:
            scan: The scan.
            frame: The frame of the lidar.
            range_step: Round ranges to multiples of this [m], so that they compress well; 0 keeps them as they are.
        """
        ranges = np.round(scan.ranges / range_step) * range_step if range_step > 0.0 else scan.ranges
        angles = scan.angles
        step = float(angles[-1] - angles[0]) / (len(angles) - 1) if len(angles) > 1 else 0.0
        return self.codec.make(
            "sensor_msgs/msg/LaserScan",
            header=self.header(scan.time, frame),
            angle_min=float(angles[0]) if len(angles) else 0.0,
            angle_max=float(angles[-1]) if len(angles) else 0.0,
            angle_increment=step,
            time_increment=scan.time_increment,
            scan_time=scan.time_increment * len(angles),
            range_min=scan.range_min,
            range_max=scan.range_max,
            ranges=ranges.astype(np.float32),
            intensities=np.zeros(0, dtype=np.float32),
        )

    def grid(self, time: float, grid: OccupancyGrid, frame: str = "map") -> Any:
        """Make a nav_msgs/OccupancyGrid of a map."""
        return self._grid(time, frame, grid.data, grid.resolution, grid.origin)

    def costmap(self, time: float, costmap: Costmap, frame: str = "map") -> Any:
        """Make a nav_msgs/OccupancyGrid of a costmap, with the values of Nav2's publisher."""
        return self.costs(time, costmap.data, costmap.resolution, costmap.origin, frame)

    def costs(
        self, time: float, costs: npt.NDArray[np.uint8], resolution: float, origin: Pose2D, frame: str = "map"
    ) -> Any:
        """Make a nav_msgs/OccupancyGrid of costs, 0 to 255, shape (rows, cols), with the values of Nav2's publisher."""
        return self._grid(time, frame, self._cost_values[costs], resolution, origin)

    def costmap_update(self, time: float, costmap: Costmap, rows: slice, cols: slice, frame: str = "map") -> Any:
        """Make a map_msgs/OccupancyGridUpdate of a rectangle of a costmap."""
        window = costmap.data[rows, cols]
        return self.codec.make(
            "map_msgs/msg/OccupancyGridUpdate",
            header=self.header(time, frame),
            x=int(cols.start),
            y=int(rows.start),
            width=window.shape[1],
            height=window.shape[0],
            data=self._cost_values[window].ravel(),
        )

    def path(self, time: float, poses: FloatArray, frame: str = "map") -> Any:
        """Make a nav_msgs/Path through poses (x, y, yaw), shape (N, 3)."""
        header = self.header(time, frame)
        stamped = [self._stamped_pose(header=header, pose=self.pose(Pose2D(x, y, yaw))) for x, y, yaw in poses.tolist()]
        return self.codec.make("nav_msgs/msg/Path", header=header, poses=stamped)

    def command(self, time: float, twist: Twist2D, frame: str = "base_link") -> Any:
        """Make a message of `command_type`."""
        if self.command_type == "geometry_msgs/msg/Twist":
            return self.twist(twist)
        return self.codec.make(self.command_type, header=self.header(time, frame), twist=self.twist(twist))

    def goal(self, time: float, pose: Pose2D, frame: str = "map") -> Any:
        """Make a geometry_msgs/PoseStamped."""
        return self._stamped_pose(header=self.header(time, frame), pose=self.pose(pose))

    def pose_estimate(self, time: float, pose: Pose2D, covariance: FloatArray | None, frame: str = "map") -> Any:
        """Make a `POSE`: a pose with its covariance of (x, y, yaw), shape (3, 3); zeros where that is not known."""
        whole = self._no_covariance if covariance is None else covariance_of(covariance)
        kind = self.codec.kind("geometry_msgs/msg/PoseWithCovariance")
        return self.codec.make(POSE, header=self.header(time, frame), pose=kind(pose=self.pose(pose), covariance=whole))

    def diagnosis(self, time: float, estimate: Estimate) -> Any:
        """Make a `DIAGNOSTICS` of what a localizer says of its estimate: a warning where the robot may be elsewhere.

        Its values are the state, and "x y yaw weight" of each place [m, rad, 1].
        """
        value = self.codec.kind("diagnostic_msgs/msg/KeyValue")
        values = [value("state", estimate.state)]
        values += [
            value(f"place {number}", f"{at.pose.x:.3f} {at.pose.y:.3f} {at.pose.yaw:.3f} {at.weight:.3f}")
            for number, at in enumerate(estimate.hypotheses, 1)
        ]
        status = self.codec.make(
            "diagnostic_msgs/msg/DiagnosticStatus",
            level=_LEVELS[estimate.state],
            name=DIAGNOSIS,
            message=describe_state(estimate),
            hardware_id="",
            values=values,
        )
        return self.codec.make(DIAGNOSTICS, header=self.header(time, ""), status=[status])

    def movers(self, time: float, movers: Iterable[MoverState], frame: str = "map") -> Any:
        """Make a visualization_msgs/MarkerArray: the outline of each mover, whose name is the marker's namespace."""
        header = self.header(time, frame)
        return self.codec.make(
            "visualization_msgs/msg/MarkerArray",
            markers=[self._outline(header, number, mover) for number, mover in enumerate(movers)],
        )

    def _grid(self, time: float, frame: str, data: npt.NDArray[np.int8], resolution: float, origin: Pose2D) -> Any:
        rows, cols = data.shape
        info = self.codec.make(
            "nav_msgs/msg/MapMetaData",
            map_load_time=self.stamp(time),
            resolution=resolution,
            width=cols,
            height=rows,
            origin=self.pose(origin),
        )
        header = self.header(time, frame)
        return self.codec.make("nav_msgs/msg/OccupancyGrid", header=header, info=info, data=data.ravel())

    def _outline(self, header: Any, number: int, mover: MoverState) -> Any:
        kind = self.codec.kind
        corners = self._outlines.get(mover.outline)
        if corners is None:
            closed = (*mover.outline, *mover.outline[:1])
            corners = self._outlines[mover.outline] = [self._point(x, y, 0.0) for x, y in closed]
        marker = kind("visualization_msgs/msg/Marker")
        fields: dict[str, Any] = {
            "header": header,
            "ns": mover.name,
            "id": number,
            "type": marker.LINE_STRIP,
            "action": marker.ADD,
            "pose": self.pose(mover.pose),
            "scale": self._vector(_LINE_WIDTH_M, 0.0, 0.0),
            "color": kind("std_msgs/msg/ColorRGBA")(_MARKER_RED, _MARKER_GREEN, _MARKER_BLUE, 1.0),
            "lifetime": kind("builtin_interfaces/msg/Duration")(sec=0, nanosec=0),
            "frame_locked": False,
            "points": corners,
            "colors": [],
            "text": "",
            "mesh_resource": "",
            "mesh_use_embedded_materials": False,
        }
        return marker(**fields, **self._textures(header))

    def _textures(self, header: Any) -> dict[str, Any]:
        """Return the fields of a marker that are for meshes, and empty here."""
        kind = self.codec.kind
        none = np.zeros(0, dtype=np.uint8)
        return {
            "texture_resource": "",
            "texture": kind("sensor_msgs/msg/CompressedImage")(header=header, format="", data=none),
            "uv_coordinates": [],
            "mesh_file": kind("visualization_msgs/msg/MeshFile")(filename="", data=none),
        }


PARTICLE_CLOUD = "nav2_msgs/msg/ParticleCloud"

_LINE = "=" * 80
_TEXT = (
    "std_msgs/Header header\nnav2_msgs/Particle[] particles\n"
    f"{_LINE}\nMSG: nav2_msgs/Particle\ngeometry_msgs/Pose pose\nfloat64 weight\n"
)
"""The same in every distribution of Nav2."""

_ENCAPSULATION = 4
"""Bytes before a CDR message; alignment counts from behind them."""

_COUNT = struct.Struct("<I")
"""How many particles follow; where there is none, the message ends with it."""


def learn_particle_cloud(codec: Codec) -> None:
    """Register the type with a codec."""
    codec.register(PARTICLE_CLOUD, _TEXT)


def encode_particles(make: MessageMaker, time: float, particles: FloatArray, frame: str = "map") -> bytes:
    """Return the CDR bytes of particles: at 2,000 of them a message of objects would take longer than the filter.

    Args:
        make: Makes messages; its codec knows the type.
        time: [s].
        particles: (x, y, yaw, weight) [m, rad, 1], shape (N, 4).
        frame: Their frame.
    """
    head = make.codec.encode(make.codec.make(PARTICLE_CLOUD, header=make.header(time, frame), particles=[]))
    if not len(particles):
        return head
    start, body = head[:_ENCAPSULATION], head[_ENCAPSULATION : -_COUNT.size] + _COUNT.pack(len(particles))
    rows = np.zeros((len(particles), 8), dtype="<f8")
    rows[:, :2], rows[:, 7] = particles[:, :2], particles[:, 3]
    rows[:, 5], rows[:, 6] = np.sin(0.5 * particles[:, 2]), np.cos(0.5 * particles[:, 2])
    return start + body + bytes(-len(body) % 8) + rows.tobytes()

"""`Bridge`: a scenario on the network of ROS 2, from its first run to the end, with what every node serves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.geometry import Pose2D
from trundle.messages import MessageMaker
from trundle.messages.qos import Qos
from trundle.mission import Mission, Observer, Scenario
from trundle.mission.scenario import Setting
from trundle.mission.setup import make_place, start_backend, wrap_backend
from trundle.navigation.behaviors.behavior import snake_case
from trundle.ros2.inlet import Record
from trundle.ros2.names import Names
from trundle.ros2.navigator_role.role import NavigatorRole
from trundle.ros2.outputs.robot import RobotOutputs
from trundle.ros2.profile import Profile
from trundle.ros2.role import BridgeContext, Driver, LiveDriver, Role, RoleName, SimulationClock
from trundle.ros2.runs import MakeObservers, NetworkRuns
from trundle.ros2.simulator_role.role import SimulatorRole
from trundle.ros2.simulator_role.services import SimulationServices
from trundle.ros2.static_frames import StaticFramesMode
from trundle.ros2.wire import Wire
from trundle.sim import Contact
from trundle.sim.footprint import FootprintChecker

if TYPE_CHECKING:
    from trundle.ros2.transport.transport import Transport
    from trundle.ros2.types import Types


ROSOUT = Qos(1000, durability="transient_local")
"""QoS of /rosout, as rcl has it."""

_LOG = "rcl_interfaces/msg/Log"
_WARN = 30
"""WARN of rcl_interfaces/msg/Log."""

Value: TypeAlias = bool | int | float | str

_TYPES: tuple[tuple[type, int, str], ...] = (
    (bool, 1, "bool_value"),
    (int, 2, "integer_value"),
    (float, 3, "double_value"),
    (str, 4, "string_value"),
)
"""Number and field of each type in rcl_interfaces/msg/ParameterValue; a bool is an int, and comes first."""

_WHY = "the parameters of trundle are set on its command line: start it again with another option"


class Rosout:
    """Publishes what is reported to the user on /rosout as well.

    Args:
        wire: The network.
    """

    def __init__(self, wire: Wire) -> None:
        self._wire, self._make = wire, MessageMaker(wire.types.codec)
        self._outlet = wire.outlet("/rosout", _LOG, ROSOUT)
        wire.warnings.listeners.append(self._write)

    def _write(self, text: str) -> None:
        wire = self._wire
        if wire.is_closing:
            return
        name = wire.transport.node.lstrip("/").replace("/", ".")
        stamp = self._make.stamp(wire.now())
        try:
            self._outlet.write(wire.types.make(_LOG, stamp=stamp, level=_WARN, name=name, msg=text))
        except TrundleError:  # a report is not worth an error
            return


class ParameterServices:
    """Serves the parameters of the node, which can be listed, described and read, and not set.

    Args:
        wire: The network.
        values: Their names and values.
    """

    def __init__(self, wire: Wire, values: Mapping[str, Value]) -> None:
        self._wire, self._values = wire, dict(sorted(values.items()))

    def open(self) -> None:
        """Offer the services, where the other side has their types."""
        wire = self._wire
        for name, handler in (
            ("ListParameters", self._list),
            ("GetParameters", self._get),
            ("GetParameterTypes", self._get_types),
            ("DescribeParameters", self._describe),
            ("SetParameters", self._set),
            ("SetParametersAtomically", self._set_at_once),
        ):
            kind = f"rcl_interfaces/srv/{name}"
            if wire.transport.has_services and wire.types.knows(f"{kind}_Request"):
                wire.serve(f"~/{snake_case(name)}", kind, handler)

    def _list(self, request: Any) -> Any:
        prefixes = [str(one) for one in request.prefixes]
        names = [
            name
            for name in self._values
            if not prefixes or any(name == prefix or name.startswith(f"{prefix}.") for prefix in prefixes)
        ]
        result = self._make("msg/ListParametersResult", names=names, prefixes=[])
        return self._make("srv/ListParameters_Response", result=result)

    def _get(self, request: Any) -> Any:
        return self._make("srv/GetParameters_Response", values=[self._value(str(name)) for name in request.names])

    def _get_types(self, request: Any) -> Any:
        types = [self._type(str(name)) for name in request.names]
        return self._make("srv/GetParameterTypes_Response", types=types)

    def _describe(self, request: Any) -> Any:
        described = [
            self._make(
                "msg/ParameterDescriptor", name=str(name), type=self._type(str(name)), description=_WHY, read_only=True
            )
            for name in request.names
        ]
        return self._make("srv/DescribeParameters_Response", descriptors=described)

    def _set(self, request: Any) -> Any:
        refused = [self._refusal() for _ in request.parameters]
        return self._make("srv/SetParameters_Response", results=refused)

    def _set_at_once(self, request: Any) -> Any:
        return self._make("srv/SetParametersAtomically_Response", result=self._refusal())

    def _refusal(self) -> Any:
        return self._make("msg/SetParametersResult", successful=False, reason=_WHY)

    def _value(self, name: str) -> Any:
        value = self._values.get(name)
        for kind, number, field in _TYPES:
            if isinstance(value, kind):
                return self._make("msg/ParameterValue", type=number, **{field: value})
        return self._make("msg/ParameterValue")

    def _type(self, name: str) -> int:
        value = self._values.get(name)
        return next((number for kind, number, _ in _TYPES if isinstance(value, kind)), 0)

    def _make(self, part: str, /, **fields: Any) -> Any:
        return self._wire.types.make(f"rcl_interfaces/{part}", **fields)


_ROLES: dict[RoleName, Callable[[BridgeContext], Role]] = {"simulator": SimulatorRole, "navigator": NavigatorRole}


class Bridge(NetworkRuns):
    """Drives a scenario, publishes it on the network, and serves what a role serves; use it in a `with` block.

    Topics, services and actions are open when it is made; nothing is heard before `run`.

    Args:
        scenario: What is driven; all lidars of the robot are on, unless it says which.
        transport: Carries the bytes; `close` closes it.
        types: The messages.
        names: Namespace and remaps.
        role: Whether other programs drive, or trundle's navigator.
        profile: Names of topics, frames and sensors: a profile, or the name of one.
        speed: How fast the run passes relative to real time, 0.1 to 50, or infinity for as fast as it can.
        record: Keeps what goes over the wire.
        driver: Drives and steers the runs, as a page does. If None, they are driven at `speed`.
        observers: Makes what else follows each run.
        static_frames: When the frames of sensors and wheels are published: where nobody else does ("auto"), "always" or
            "never".
        report: Gets warnings and remarks. If None, the log does.

    Attributes:
        wire: What is published, heard and served.
        context: What the role plugs into.

    Raises:
        InputError: If the scenario, the profile or a name cannot be used.
    """

    def __init__(
        self,
        scenario: Scenario,
        transport: Transport,
        types: Types,
        names: Names,
        *,
        role: RoleName = "simulator",
        profile: Profile | str = "plain",
        speed: float = 1.0,
        record: Record | None = None,
        driver: Driver | None = None,
        observers: MakeObservers | None = None,
        static_frames: StaticFramesMode = "auto",
        report: Callable[[str], None] | None = None,
    ) -> None:
        profile = Profile.load(profile) if isinstance(profile, str) else profile
        super().__init__(transport, types, names, record=record, observers=observers, report=report)
        try:
            mission = self._opened.enter_context(build_mission(scenario, profile))
            driver = LiveDriver(speed=speed) if driver is None else driver
            self.context = BridgeContext(self.wire, profile, SimulationClock(), mission, driver, static_frames)
            self.wire.now = lambda: self.context.clock.now
            self._outputs = RobotOutputs(self.context)
            self._role = _ROLES[role](self.context)
            self._opened.callback(self._role.close)
            self._role.open()
            SimulationServices(self.context, prefix=profile.services_prefix).open()
            Rosout(self.wire)
            ParameterServices(self.wire, describe_parameters(mission, profile, role)).open()
            self.wire.on_lost(self._role.lost)
        except BaseException:
            self.close()
            raise

    def _own_observers(self) -> Sequence[Observer]:
        return (self._outputs,)


def describe_parameters(mission: Mission, profile: Profile, role: RoleName) -> dict[str, Value]:
    """Return what the node tells of itself as parameters: what drives, on what, and in which frames."""
    scenario, frames = mission.scenario, profile.frames
    names = {
        "planner": scenario.planner,
        "controller": mission.navigator.controller_name,
        "smoother": scenario.smoother,
        "localizer": scenario.localizer,
        "backend": scenario.backend.name,
    }
    return {
        "use_sim_time": profile.topics.clock is not None,
        "role": role,
        "robot": mission.robot.name,
        "scenario": scenario.title,
        "seed": scenario.seed,
        "frames.map": frames.map,
        "frames.odom": frames.odom,
        "frames.base": frames.base,
        "limits.linear_speed": mission.robot.limits.linear_speed,
        "limits.angular_speed": mission.robot.limits.angular_speed,
        **{name: "" if one is None else str(one) for name, one in names.items()},
    }


def build_mission(scenario: Scenario, profile: Profile) -> Mission:
    """Start the scenario on its simulator, with the lidars and the start of a profile where it does not say otherwise.

    Raises:
        InputError: If it cannot be used.
    """
    place = make_place(scenario)
    place = replace(place, robot=profile.fit(place.robot))
    if "lidar" not in scenario.backend.options and not scenario.lidar:
        scenario = scenario.model_copy(update={"lidar": bool(place.robot.lidars)})
    setting = scenario.prepare(place)
    if scenario.start is not None:
        touched = _find_touched(setting, setting.start)
        if touched:
            start = setting.start
            raise InputError(
                f"at its start ({start.x:.2f}, {start.y:.2f}, {np.degrees(start.yaw):.0f}°) the robot would touch "
                f"{touched[0].other}: give another --start, or none"
            )
    elif profile.start is not None:
        start = Pose2D.of(profile.start)
        is_inside = bool(setting.grid.contains(*setting.grid.world_to_cell(start.x, start.y)))
        if is_inside and not _find_touched(setting, start):
            setting = scenario.model_copy(update={"start": start.as_tuple()}).prepare(place)
    sim = wrap_backend(setting.scenario, start_backend(setting.scenario, setting.world, setting.robot))
    return setting.with_simulator(sim)


def _find_touched(setting: Setting, pose: Pose2D) -> tuple[Contact, ...]:
    """Return what the robot would touch at a pose."""
    return FootprintChecker(setting.world, setting.robot).find(np.array([pose.as_tuple()]))

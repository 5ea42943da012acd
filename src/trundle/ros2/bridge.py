"""`Bridge`: a scenario on the network of ROS 2, from its first run to the end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.mission import Mission, Observer, Scenario
from trundle.mission.scenario import Setting
from trundle.mission.setup import make_place, start_backend, wrap_backend
from trundle.ros2.inlet import Record
from trundle.ros2.names import Names
from trundle.ros2.navigator_role.role import NavigatorRole
from trundle.ros2.node_services import ParameterServices, Rosout, Value
from trundle.ros2.outputs.robot import RobotOutputs
from trundle.ros2.profile import Profile
from trundle.ros2.role import BridgeContext, Driver, LiveDriver, Role, RoleName, SimulationClock
from trundle.ros2.runs import MakeObservers, NetworkRuns
from trundle.ros2.simulator_role.role import SimulatorRole
from trundle.ros2.simulator_role.services import SimulationServices
from trundle.ros2.static_frames import StaticFramesMode
from trundle.sim import Contact
from trundle.sim.footprint import FootprintChecker

if TYPE_CHECKING:
    from trundle.ros2.transport.transport import Transport
    from trundle.ros2.types import Types

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

"""`NavigatorRole`: trundle drives, and ROS programs use it as Nav2; actions that it does not serve are refused."""

from __future__ import annotations

import threading
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from trundle.errors import InputError
from trundle.maps import OccupancyGrid
from trundle.mission import Cancel, Episode, Observer, Restart, RunInfo, Session, Step
from trundle.mission.scenario import Setting
from trundle.mission.setup import Place, SessionOptions, load_masks, session_options
from trundle.ros2.actions import Action, ActionGoal
from trundle.ros2.navigator_role.behaviors import (
    AssistedTeleop,
    Behave,
    read_back_up,
    read_drive_on_heading,
    read_spin,
    read_wait,
)
from trundle.ros2.navigator_role.context import NAVIGATOR, Beliefs, Kit
from trundle.ros2.navigator_role.driving import Follow, Navigate
from trundle.ros2.navigator_role.inputs import PoseInputs
from trundle.ros2.navigator_role.lifecycle import Lifecycle
from trundle.ros2.navigator_role.localization import NavigationDiagnosis, ParticleOutput, PoseOutput, StateOutput
from trundle.ros2.navigator_role.outputs import (
    FootprintOutput,
    GlobalCostmapOutput,
    LocalCostmapOutput,
    MapOutput,
    MarkerOutput,
    PlanOutput,
)
from trundle.ros2.navigator_role.plans import ComputePath, PlanServer, SmoothPath
from trundle.ros2.navigator_role.services import OPTIONAL, MapServices, Services
from trundle.ros2.navigator_role.tasks import Tasks
from trundle.ros2.navigator_role.waypoints import FollowWaypoints
from trundle.ros2.outputs.output import Output
from trundle.ros2.role import BridgeContext
from trundle.ros2.wire import Wire


@dataclass(frozen=True, slots=True)
class Refusal:
    """What is refused.

    Attributes:
        name: Its name on the network.
        type_name: Its type.
        call: The call of `BasicNavigator` that asks for it, for the docs.
        why: The reason, with what to do instead.
    """

    name: str
    type_name: str
    call: str
    why: str


REFUSED_ACTIONS = (
    Refusal(
        "follow_gps_waypoints",
        "nav2_msgs/action/FollowGPSWaypoints",
        "followGpsWaypoints",
        "trundle knows no geographic coordinates: use goToPose or goThroughPoses on the map",
    ),
    Refusal("dock_robot", "nav2_msgs/action/DockRobot", "dockRobotByPose, dockRobotByID", "trundle has no docks"),
    Refusal("undock_robot", "nav2_msgs/action/UndockRobot", "undockRobot", "trundle has no docks"),
    Refusal(
        "compute_route",
        "nav2_msgs/action/ComputeRoute",
        "getRoute",
        "trundle has no route graph: use getPath or getPathThroughPoses",
    ),
    Refusal(
        "compute_and_track_route",
        "nav2_msgs/action/ComputeAndTrackRoute",
        "getAndTrackRoute",
        "trundle has no route graph: use goThroughPoses",
    ),
)
"""The actions that `BasicNavigator` of any distribution may ask for, and that are refused."""


class Refuse:
    """Refuses the goals of an action.

    Where the distribution's result has a text for the reason, a goal is accepted and aborted with it. Otherwise it is
    rejected, as that is what clients look at, and the reason is reported here.

    Args:
        wire: What serves it.
        refusal: What is refused.
    """

    def __init__(self, wire: Wire, refusal: Refusal) -> None:
        self._wire, self._refusal = wire, refusal
        self._says = wire.types.has(f"{refusal.type_name}_Result", "error_msg")

    def accepts(self, request: Any) -> bool:
        """Return whether the result can say why the goal is refused."""
        name, why = self._refusal.name, self._refusal.why
        self._wire.warn(f"{name}: refused", f"a goal of {name} is refused: {why}")
        return self._says

    def accepted(self, goal: ActionGoal) -> None:
        """Abort the goal with the reason."""
        result = f"{self._refusal.type_name}_Result"
        goal.abort(error_code=self._wire.types.constant(result, "UNKNOWN", 1), error_msg=self._refusal.why)

    def cancel(self, goal: ActionGoal) -> bool:
        """Return False: nothing runs that could be cancelled."""
        return False


_TAKES_S = 30.0
"""How long a run on another map may take to begin [s]: a busy computer and a big map take a few."""

_LOOK_S = 0.005


@dataclass(slots=True, eq=False)
class LoadedMap:
    """A map that was loaded, on which the next run drives.

    Attributes:
        setting: The robot's map and navigator.
        use: Called by the thread that drives, before the run begins.
        begun: Set once the run has begun.
    """

    setting: Setting
    use: Callable[[], None] = lambda: None
    begun: threading.Event = field(default_factory=threading.Event)


class NavigatorRole:
    """Drives by goals, paths and behaviors from the network, and publishes what a navigator of Nav2 does.

    Args:
        context: What it plugs into.

    Attributes:
        lifecycle: The state of Nav2's nodes.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._context = context
        tasks = Tasks(context)
        self._kit = Kit(context, tasks, Beliefs(context))
        self._plans = PlanServer(self._kit)
        self._loaded: LoadedMap | None = None
        self._lock = threading.Lock()
        self.lifecycle = Lifecycle(context.wire, self._change_state)

    def open(self) -> None:
        """Open topics, services and actions."""
        kit = self._kit
        self._pose_output, self._markers = PoseOutput(kit), MarkerOutput(kit)
        self._outputs: list[Output] = [
            self._pose_output,
            ParticleOutput(kit),
            StateOutput(kit),
            NavigationDiagnosis(kit),
            MapOutput(kit),
            GlobalCostmapOutput(kit),
            LocalCostmapOutput(kit),
            FootprintOutput(kit, "global_costmap"),
            FootprintOutput(kit, "local_costmap"),
            PlanOutput(kit),
            self._markers,
        ]
        self._poses = poses = PoseInputs(kit, self._pose_output.answer)
        poses.open()
        self._open_actions()
        self.lifecycle.open(self._serve)
        Services(kit, poses).open(self._serve)
        MapServices(kit, self.use_map).open(self._serve)

    def begin(self, observers: Sequence[Observer], seed: int | None) -> Session:
        """Begin a run; see `Role`. It waits for goals."""
        loaded = self._take_map()
        mission = self._context.mission
        options = session_options(mission.scenario, mission.grid, mission.navigator.robot)
        return self._begin(loaded, observers, seed, options)

    def _begin(
        self, loaded: LoadedMap | None, observers: Sequence[Observer], seed: int | None, options: SessionOptions
    ) -> Session:
        """Begin a run; drives go on in one on a map that was loaded, and then `use_map` returns."""
        self._pose_output.begin()
        outputs = NavigatorOutputs(self._kit, self._outputs, self._markers)
        agent = self._context.mission.navigator
        session = self._context.begin_session(agent, [*observers, outputs], seed, options)
        self._kit.tasks.drive.resume()
        if loaded is not None:
            loaded.begun.set()
        with self._lock:
            waits = self._loaded is not None
        if waits:
            self._carry("another map was loaded")
            self._restart()
        return session

    # Another map -----------------------------------------------------------------------------------------------------

    def use_map(self, path: Path) -> None:
        """Let the robot drive on another map: a run on it begins where the robot stands, with the goals that are left.

        It returns once that run takes goals and poses, and does the rounds of the listening thread while it waits.

        Raises:
            InputError: If the map cannot be used, or the run on it does not begin in time.
        """
        loaded = self._prepare(path)
        self._carry(f"another map was loaded: {path}")
        self._restart(loaded)
        wire, until = self._context.wire, clock.monotonic() + _TAKES_S
        while not (loaded.begun.wait(_LOOK_S) or wire.is_closing):
            wire.do_round()
            if clock.monotonic() > until:
                raise InputError(f"the run has not begun again within {_TAKES_S:g} s: it takes the map once it does")
        if not loaded.begun.is_set():
            raise InputError("trundle is ending")
        wire.warnings.note(f"the robot drives on another map: {path}")

    def _carry(self, why: str) -> None:
        self._kit.tasks.carry(why)
        self._poses.carry()

    def _restart(self, loaded: LoadedMap | None = None) -> None:
        """Let the run begin again on a map, or on one whose restart was refused as this run was about to begin."""
        with self._lock:
            self._loaded = loaded or self._loaded
            if self._loaded is not None:
                self._context.driver.steering.put(Restart(), by="load_map")

    def _prepare(self, path: Path) -> LoadedMap:
        """Make the robot's map and navigator from the file of another map; the simulated world stays."""
        mission = self._context.mission
        scenario = mission.scenario
        if not scenario.known_map:
            raise InputError("the robot drives without a map: start trundle with one")
        if scenario.map is not None:
            raise InputError(f"the simulated world is made from the map, and would stay: start trundle with {path}")
        limit = None if scenario.map_options is None else scenario.map_options.max_cells
        grid = OccupancyGrid.load(path, compat=scenario.compat, max_cells=limit)
        here = self._kit.beliefs.stands.as_tuple()
        place = Place(mission.world, mission.robot, grid, scenario.floor_z or 0.0, *load_masks(scenario))
        given = {"start": here, "goal": here, "goals": None, "unmapped": None, "map_errors": None}
        setting = scenario.model_copy(update=given).prepare(place)
        return LoadedMap(replace(setting, scenario=scenario, goals=()))

    def _take_map(self) -> LoadedMap | None:
        """Drive on the map that was loaded, if one was; the thread that drives does that, between two runs."""
        with self._lock:
            loaded, self._loaded = self._loaded, None
        if loaded is not None:
            here = replace(loaded.setting, start=self._kit.beliefs.stands)
            self._context.mission = here.with_simulator(self._context.mission.sim)
            self._kit.beliefs.map = here.grid
            loaded.use()
        return loaded

    def lost(self, why: str) -> None:
        """Stop the robot, because whoever asked it to drive is out of reach."""
        if why:
            self._stop(f"the other side is lost: {why}")

    def close(self) -> None:
        """End what runs, and tell its clients."""
        self._plans.close()
        self._kit.tasks.end("the bridge has ended")
        self._kit.tasks.flush()

    def _change_state(self, refuses: str) -> None:
        self._kit.tasks.refuse("lifecycle", refuses)
        if refuses:
            self._stop(refuses)

    def _stop(self, why: str) -> None:
        """Stop the robot, and end what it was asked to do; so does a run that is about to begin again."""
        try:
            self._kit.tasks.end(why)
            self._poses.drop()
        finally:  # last: what ends may give the run something before
            self._context.driver.steering.put(Cancel(), by=NAVIGATOR, waits=True)

    # Opening --------------------------------------------------------------------------------------------------------

    def _open_actions(self) -> None:
        kit = self._kit
        self._act("navigate_to_pose", "NavigateToPose", Navigate(kit, "navigate_to_pose", through=False))
        self._act(
            "navigate_through_poses", "NavigateThroughPoses", Navigate(kit, "navigate_through_poses", through=True)
        )
        self._act("follow_path", "FollowPath", Follow(kit, "follow_path"))
        to, through = "compute_path_to_pose", "compute_path_through_poses"
        self._act(to, "ComputePathToPose", ComputePath(kit, self._plans, to, through=False))
        self._act(through, "ComputePathThroughPoses", ComputePath(kit, self._plans, through, through=True))
        for name, action, read in (
            ("spin", "Spin", read_spin),
            ("backup", "BackUp", read_back_up),
            ("drive_on_heading", "DriveOnHeading", read_drive_on_heading),
            ("wait", "Wait", read_wait),
        ):
            self._act(name, action, Behave(kit, name, action, read))
        self._act("follow_waypoints", "FollowWaypoints", FollowWaypoints(kit, "follow_waypoints"))
        self._act("smooth_path", "SmoothPath", SmoothPath(kit, "smooth_path"))
        teleop = AssistedTeleop(kit, "assisted_teleop")
        self._act("assisted_teleop", "AssistedTeleop", teleop)
        teleop.open()
        self._outputs.append(teleop)
        wire = self._context.wire
        for refusal in REFUSED_ACTIONS:
            self._act(refusal.name, refusal.type_name.rpartition("/")[2], Refuse(wire, refusal), optional=True)

    def _act(self, name: str, action: str, served: Action, *, optional: bool = False) -> None:
        """Serve an action if the other side knows its type; a missing one is reported, unless it is optional."""
        wire, type_name = self._context.wire, f"nav2_msgs/action/{action}"
        if not wire.transport.has_services or self._knows(type_name, "Goal", "Result", "Feedback"):
            wire.act(name, type_name, served)
        elif not optional:
            self._warn_of_type(type_name)

    def _serve(self, name: str, type_name: str, handler: Callable[[Any], Any]) -> None:
        """Serve a service if the other side knows its type; a missing one is reported, unless it is optional."""
        wire = self._context.wire
        if not wire.transport.has_services or self._knows(type_name, "Request", "Response"):
            wire.serve(name, type_name, handler)
        elif type_name not in OPTIONAL:
            self._warn_of_type(type_name)

    def _knows(self, type_name: str, *parts: str) -> bool:
        """Return whether the other side has a type, and its text can be read; later it may be too late to ask."""
        try:
            return all(self._context.wire.types.knows(f"{type_name}_{part}") for part in parts)
        except InputError:
            return False

    def _warn_of_type(self, type_name: str) -> None:
        package = type_name.partition("/")[0]
        distro = self._context.wire.types.distro
        debian = package.replace("_", "-")
        self._context.wire.warn(
            f"{package} is not installed",
            f"the ROS {distro} in use has no {type_name}, so what needs it is not served: sudo apt install "
            f"ros-{distro}-{debian}",
        )


class NavigatorOutputs:
    """Publishes what the navigator knows of a run, and sends feedback.

    Args:
        kit: What the navigator works with.
        outputs: What is published.
        markers: The output that knows whether rollouts are wanted.
    """

    def __init__(self, kit: Kit, outputs: Sequence[Output], markers: MarkerOutput) -> None:
        self._kit, self._outputs, self._markers = kit, outputs, markers

    @property
    def wants_rollouts(self) -> bool:
        """Whether somebody looks at the rollouts."""
        return self._markers.wants_rollouts

    def on_start(self, run: RunInfo) -> None:
        """Do nothing: the first period tells what is published."""

    def on_step(self, step: Step) -> None:
        """Publish the end of a control period."""
        time = self._kit.context.clock.offset + step.state.time
        self._kit.beliefs.take(step, time)
        for output in self._outputs:
            output.publish(step, time)
        self._kit.tasks.follow(step)

    def on_end(self, episode: Episode) -> None:
        """Do nothing: the next run may follow."""

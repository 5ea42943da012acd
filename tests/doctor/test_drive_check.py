"""The robot check: planted errors are measured to 1 % and named."""

from dataclasses import replace
from typing import Self

import pytest

from trundle.doctor import DriveCheck, check_drive
from trundle.errors import InputError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot, WheelSpeeds
from trundle.sim import RobotState, Simulator, simulate
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.worlds import World

EMPTY = World("empty", ())
BACKENDS = pytest.mark.parametrize("backend", ["kinematic", "mujoco"])


class Rewired:
    """A simulator whose wheels are wired wrongly: commands and readings go through the same wrong wires."""

    def __init__(
        self, simulator: Simulator, *, swapped: bool = False, signs: tuple[int, int] = (1, 1), gain: float = 1
    ) -> None:
        self._simulator = simulator
        self._swapped = swapped
        self._signs = signs
        self._gain = gain
        self.robot = simulator.robot

    def _wire(self, wheels: WheelSpeeds, gain: float = 1.0) -> WheelSpeeds:
        left, right = (sign * speed * gain for sign, speed in zip(self._signs, wheels, strict=True))
        return WheelSpeeds(right, left) if self._swapped else WheelSpeeds(left, right)

    def _seen(self, state: RobotState) -> RobotState:
        return replace(
            state, wheel_positions=self._wire(state.wheel_positions), wheel_speeds=self._wire(state.wheel_speeds)
        )

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        return self._seen(self._simulator.reset(pose, seed=seed))

    def step(self, command: Twist2D, dt: float) -> RobotState:
        drive = self.robot.drive
        speeds = self._wire(drive.wheel_speeds(command), self._gain)
        return self._seen(self._simulator.step(drive.twist(speeds), dt))

    def close(self) -> None:
        self._simulator.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def kinds(check: DriveCheck) -> list[str]:
    return [finding.kind for finding in check.findings]


@BACKENDS
@pytest.mark.parametrize("name", ["nova_carter", "turtlebot3_burger", "jackal"])
def test_a_robot_as_configured_raises_nothing(backend: str, name: str) -> None:
    with simulate(EMPTY, name, backend=backend) as simulator:
        check = check_drive(simulator, start=Pose2D(2.0, -1.0, 2.5))
    drive = Robot.load(name).drive
    assert check.findings == ()
    assert check.wheel_radius == pytest.approx(drive.wheel_radius, rel=0.01)
    assert check.track_width == pytest.approx(drive.track_width, rel=0.01)
    assert check.wheel_tracking == pytest.approx(1.0, rel=0.01)
    assert check.slip is not None
    assert check.slip < 0.01


@BACKENDS
@pytest.mark.parametrize(
    ("radius", "track"),
    [(0.10, 0.4132), (0.20, 0.4132), (0.14, 0.54), (0.14, 0.30), (0.12, 0.5), (0.05, 0.4132), (0.14, 1.5)],
)
def test_wrong_radius_and_track_are_found_with_their_true_values(backend: str, radius: float, track: float) -> None:
    with simulate(EMPTY, "nova_carter", backend=backend) as simulator:
        configured = simulator.robot.drive.model_copy(update={"wheel_radius": radius, "track_width": track})
        check = check_drive(simulator, configured=configured)
    assert check.wheel_radius == pytest.approx(0.14, rel=0.01)
    assert check.track_width == pytest.approx(0.4132, rel=0.01)
    wrong = {"wheel_radius": radius != 0.14, "track_width": track != 0.4132}
    assert kinds(check) == [kind for kind, is_wrong in wrong.items() if is_wrong]


def test_the_wrong_wheel_base_of_carter_over_rotates_by_31_percent() -> None:
    with simulate(EMPTY, "nova_carter", backend="kinematic") as simulator:
        configured = simulator.robot.drive.model_copy(update={"track_width": 0.54})
        (finding,) = check_drive(simulator, configured=configured).findings
    assert "the robot turns 31% too far. Set it to 0.4132" in finding.message
    assert finding.configured == 0.54


@BACKENDS
def test_swapped_wheels_are_named(backend: str) -> None:
    with Rewired(simulate(EMPTY, "nova_carter", backend=backend), swapped=True) as simulator:
        check = check_drive(simulator)
    assert kinds(check) == ["wheels_swapped"]
    assert check.track_width == pytest.approx(0.4132, rel=0.01)


@BACKENDS
def test_swapped_wheels_do_not_hide_a_wrong_track(backend: str) -> None:
    with Rewired(simulate(EMPTY, "nova_carter", backend=backend), swapped=True) as simulator:
        check = check_drive(simulator, configured=simulator.robot.drive.model_copy(update={"track_width": 0.54}))
    assert kinds(check) == ["wheels_swapped", "track_width"]
    assert check.track_width == pytest.approx(0.4132, rel=0.01)


@BACKENDS
@pytest.mark.parametrize(("signs", "joint"), [((-1, 1), "joint_wheel_left"), ((1, -1), "joint_wheel_right")])
def test_a_reversed_wheel_is_named(backend: str, signs: tuple[int, int], joint: str) -> None:
    with Rewired(simulate(EMPTY, "nova_carter", backend=backend), signs=signs) as simulator:
        check = check_drive(simulator)
    assert kinds(check) == ["wheel_reversed"]
    assert joint in check.findings[0].message
    assert check.wheel_radius == pytest.approx(0.14, rel=0.01)


@BACKENDS
def test_swapped_and_reversed_wheels_are_distinguished(backend: str) -> None:
    with Rewired(simulate(EMPTY, "nova_carter", backend=backend), swapped=True, signs=(-1, -1)) as simulator:
        check = check_drive(simulator)
    assert kinds(check) == ["wheel_reversed", "wheel_reversed", "wheels_swapped"]


def test_a_smaller_wheel_is_distinguished_from_two_wrong_ones() -> None:
    with MujocoSimulator(EMPTY, Robot.load("nova_carter")) as simulator:
        simulator.model.geom_size[simulator.model.geom("robot:wheel_left").id] *= 0.97
        check = check_drive(simulator)
    assert kinds(check) == ["unequal_wheels"]
    assert check.wheel_radii == pytest.approx((0.97 * 0.14, 0.14), rel=0.01)


def test_a_wheel_without_friction_is_named() -> None:
    with MujocoSimulator(EMPTY, Robot.load("nova_carter")) as simulator:
        # MuJoCo takes the larger friction of the two that meet.
        for name in ("robot:wheel_left", "world:floor"):
            simulator.model.geom_friction[simulator.model.geom(name).id, 0] = 0.0
        check = check_drive(simulator)
    assert kinds(check) == ["does_not_move"]
    assert "joint_wheel_left turns, but hardly moves the robot" in check.findings[0].message


def test_a_wrong_radius_is_found_on_a_slippery_floor() -> None:
    with MujocoSimulator(EMPTY, Robot.load("nova_carter")) as simulator:
        simulator.model.geom_friction[:, 0] = simulator.model.geom_friction[:, 0].clip(max=0.1)
        check = check_drive(simulator, configured=simulator.robot.drive.model_copy(update={"wheel_radius": 0.10}))
    assert kinds(check) == ["wheel_radius", "slip"]
    assert check.wheel_radius == pytest.approx(0.14, rel=0.01)


@pytest.mark.parametrize("friction", [0.1, 0.05, 0.01])
def test_a_slippery_floor_is_named_and_not_taken_for_a_wrong_radius(friction: float) -> None:
    with MujocoSimulator(EMPTY, Robot.load("nova_carter")) as simulator:
        simulator.model.geom_friction[:, 0] = simulator.model.geom_friction[:, 0].clip(max=friction)
        check = check_drive(simulator)
    assert kinds(check) == ["slip"]
    assert check.slip is not None
    assert check.slip_gentle is not None
    assert check.slip > check.slip_gentle + 0.1


def test_wheels_that_reach_other_speeds_are_named_with_the_likely_cause() -> None:
    with Rewired(simulate(EMPTY, "nova_carter", backend="kinematic"), gain=0.0174533) as simulator:
        check = check_drive(simulator)
    assert kinds(check) == ["wheels_do_not_turn"]
    assert "degrees used as radians" in check.findings[0].message
    with Rewired(simulate(EMPTY, "nova_carter", backend="kinematic"), gain=0.8) as simulator:
        check = check_drive(simulator)
    assert kinds(check) == ["wheel_speed"]
    assert check.wheel_radius == pytest.approx(0.14, rel=0.01)


def test_wheels_in_the_air_are_distinguished_from_a_small_radius() -> None:
    with MujocoSimulator(EMPTY, Robot.load("nova_carter")) as simulator:
        simulator.model.geom_friction[:, 0] = 0.0
        check = check_drive(simulator)
    assert kinds(check) == ["does_not_move"]
    assert check.wheel_radius is None


class Scrubbing(Rewired):
    """A robot that turns short on the spot and too far in a curve, by shares that were measured in PhysX."""

    def __init__(self, simulator: Simulator, spin: float, curve: float) -> None:
        super().__init__(simulator)
        self._spin, self._curve = spin, curve

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        self._pose = pose
        return super().reset(pose, seed=seed)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        state = super().step(command, dt)
        share = self._spin if abs(state.twist.v) < 1e-3 else self._curve
        self._pose = Twist2D(state.twist.v, state.twist.w * (1.0 + share)).integrate(self._pose, dt)
        return replace(state, pose=self._pose)


@pytest.mark.parametrize(
    ("spin", "curve"),
    # Tyres and casters of 20 and 25 mm; with 128 iterations; 4 and 25 mm.
    [(-0.066, 0.086), (-0.050, 0.041), (-0.035, 0.113)],
)
def test_wide_tyres_scrub_and_are_not_taken_for_unequal_wheels(spin: float, curve: float) -> None:
    with Scrubbing(simulate(EMPTY, "nova_carter", backend="kinematic"), spin, curve) as simulator:
        (finding,) = check_drive(simulator).findings
    assert finding.kind == "caster_scrub"
    assert f"{1.0 + spin:.1%} of the command and a curve {1.0 + curve:.1%}" in finding.message
    assert finding.measured == pytest.approx((1.0 + curve) / (1.0 + spin) - 1.0, abs=0.005)


@pytest.mark.parametrize(
    ("spin", "curve"),
    # Contacts of 4 mm with 32 and 64 iterations, spheres; wide casters with a friction of 0.1 and 0.
    [(-0.011, 0.014), (-0.0093, 0.0132), (-0.008, 0.010), (-0.037, 0.0015), (-0.030, -0.026)],
)
def test_narrow_contacts_and_casters_that_slide_do_not_scrub(spin: float, curve: float) -> None:
    with Scrubbing(simulate(EMPTY, "nova_carter", backend="kinematic"), spin, curve) as simulator:
        found = kinds(check_drive(simulator))
    assert "caster_scrub" not in found
    assert "unequal_wheels" not in found


class OnRails(Rewired):
    """A robot that keeps its heading whatever its wheels do, as a car with its steering held."""

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        self._pose = pose
        return super().reset(pose, seed=seed)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        state = super().step(command, dt)
        self._pose = Twist2D(state.twist.v, 0.0).integrate(self._pose, dt)
        return replace(state, pose=self._pose, twist=Twist2D(state.twist.v, 0.0))


def test_a_robot_that_cannot_turn_on_the_spot_is_no_differential_drive() -> None:
    with OnRails(simulate(EMPTY, "nova_carter", backend="kinematic")) as simulator:
        check = check_drive(simulator)
    assert kinds(check) == ["does_not_turn"]
    assert check.track_width is None
    assert "a car-like robot is not a differential drive" in check.findings[0].message


def test_too_little_room_is_reported_with_what_was_touched() -> None:
    wall = Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((1.0, 0.0, 0.5)))
    with simulate(World("wall", (wall,)), "nova_carter", backend="kinematic") as simulator:
        check = check_drive(simulator)
    assert kinds(check) == ["contact"]
    assert "touched wall" in check.findings[0].message


def test_another_kind_of_drive_is_refused() -> None:
    with (
        simulate(EMPTY, "nova_carter", backend="kinematic") as simulator,
        pytest.raises(InputError, match="differential"),
    ):
        check_drive(simulator, configured=object())  # type: ignore[arg-type]

"""Checks a robot's drive configuration from its motion: wheel radius, track, order, signs and slip."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from trundle.doctor.drive_legs import Leg, Wheel, drive_legs, fit_wheels
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.robots import DifferentialDrive
from trundle.sim import Simulator

Kind = Literal[
    "wheel_radius",
    "track_width",
    "wheels_swapped",
    "wheel_reversed",
    "unequal_wheels",
    "caster_scrub",
    "slip",
    "wheel_speed",
    "wheels_do_not_turn",
    "does_not_move",
    "does_not_turn",
    "contact",
]

TOLERANCE = 0.02
"""Relative error above which a configured value is reported as wrong."""

SLIP_TOLERANCE = 0.05
"""Share of lost wheel travel above which slip is reported."""

_SCRUB = 0.05
"""How much farther than a spin a curve must turn, both as shares of their commands, to be reported as scrub.

In PhysX it is 12 to 16 % with casters of the real width, and at most 2 % with contacts of 4 mm or with spheres."""

_STRAIGHT = 0.01
"""Difference of the wheels' radii, as seen in a straight, up to which the wheels are equal."""

_TURNS = 0.02
"""Wheels that reach less than this share of the commanded speed are reported as not turning."""

_MOVES = 0.1
"""Share of the configured effect below which a wheel is reported as not moving the robot, or the wheels as not turning
it.
"""


@dataclass(frozen=True, slots=True)
class DriveFinding:
    """A fault in a robot's drive.

    Attributes:
        kind: Kind of fault.
        message: Description and fix.
        configured: The configured value, if any.
        measured: The correct value.
    """

    kind: Kind
    message: str
    configured: float | None = None
    measured: float | None = None


@dataclass(frozen=True, slots=True)
class DriveCheck:
    """Drive parameters identified from a robot's motion.

    Attributes:
        wheel_radius: Effective radius, the mean of both wheels [m]; None if the robot did not move.
        track_width: Effective track width [m]; None if the robot did not move.
        slip: Share of the wheels' travel lost while accelerating from rest at the robot's limit, until one second
            after it; the greater of straight and turning; None if the robot did not move.
        slip_gentle: The same at a small acceleration. The increase between the two is due to slip.
        wheel_radii: Effective radii, (left, right) [m].
        wheel_tracking: Speed of the wheels as a share of the commanded speed, while the command is constant.
        findings: Faults; empty if the configuration is correct. If the robot slips even at a small acceleration,
            its radius and track are not checked; neither are they with wide tyres that scrub.
    """

    wheel_radius: float | None
    track_width: float | None
    slip: float | None
    slip_gentle: float | None
    wheel_radii: tuple[float, float] | None
    wheel_tracking: float | None
    findings: tuple[DriveFinding, ...]


def check_drive(
    simulator: Simulator, *, configured: DifferentialDrive | None = None, start: Pose2D = Pose2D(0.0, 0.0)
) -> DriveCheck:
    """Drive a straight, a spin and a circle, and identify the drive from the motion.

    The radius is measured at constant speed after a gentle start, where there is no slip; slip is the travel lost while
    accelerating, at a small and at the maximum acceleration. The drive needs 3 m of free, level floor ahead of `start`
    and 1.5 m to its left.

    Args:
        simulator: The simulator of the robot.
        configured: The drive that commands are computed with; by default that of the simulator's robot.
        start: Start pose, map frame.

    Raises:
        SimulationError: If the simulation fails.
    """
    drive = simulator.robot.drive if configured is None else configured
    if not isinstance(drive, DifferentialDrive):
        raise InputError(f"only differential drives can be checked, got {type(drive).__name__}")
    legs = drive_legs(simulator, drive, start)
    touched = sorted({name for leg in legs for name in leg.touched})
    if touched:
        message = f"the robot touched {', '.join(touched)}: give it 3 m of free floor ahead and 1.5 m to its left"
        return _stopped(DriveFinding("contact", message))
    gentle = [leg for leg in legs if not leg.hard]
    tracking = sum(leg.tracking for leg in gentle) / len(gentle)
    if tracking < _TURNS:
        return _stopped(_still_wheels(drive, tracking), tracking)
    left, right = fit_wheels(gentle)
    for name, wheel in ((drive.left_joint, left), (drive.right_joint, right)):
        if wheel.radius < _MOVES * drive.wheel_radius:
            return _stopped(_no_traction(name, wheel, drive), tracking)
    if min(left.track, right.track) > drive.track_width / _MOVES:
        return _stopped(_held_heading(drive), tracking)
    return _judge(drive, legs, left, right, tracking)


def _judge(drive: DifferentialDrive, legs: list[Leg], left: Wheel, right: Wheel, tracking: float) -> DriveCheck:
    radius = (left.radius + right.radius) / 2.0
    track = (left.track + right.track) / 2.0
    gentle = max(leg.lost(left, right) for leg in legs if not leg.hard)
    hard = max(leg.lost(left, right) for leg in legs if leg.hard)
    findings = _wiring(drive, left, right)
    in_straight = next(leg for leg in legs if leg.hard).lost(left, right)
    scrub = None if findings or in_straight > SLIP_TOLERANCE else _scrub(legs, track)
    if scrub is not None:
        findings.append(scrub)
        hard = in_straight  # what is lost in a turn is scrub
    elif gentle <= SLIP_TOLERANCE:
        findings += _sizes(drive, left, right, radius, track)
    if hard > SLIP_TOLERANCE:
        findings.append(_slippery(hard, gentle))
    if abs(tracking - 1.0) > SLIP_TOLERANCE:
        findings.append(_wrong_speed(tracking))
    return DriveCheck(radius, track, hard, gentle, (left.radius, right.radius), tracking, tuple(findings))


def _wiring(drive: DifferentialDrive, left: Wheel, right: Wheel) -> list[DriveFinding]:
    findings: list[DriveFinding] = []
    for name, wheel in ((drive.left_joint, left), (drive.right_joint, right)):
        if wheel.reversed:
            findings.append(
                DriveFinding(
                    "wheel_reversed",
                    f"{name} turns in the wrong direction: a positive speed drives backward. Flip its axis, or negate "
                    "its command",
                )
            )
    if not left.on_left and right.on_left:
        findings.append(
            DriveFinding(
                "wheels_swapped",
                f"{drive.left_joint} is the right wheel and {drive.right_joint} the left one: swap left_joint and "
                "right_joint",
            )
        )
    return findings


def _scrub(legs: list[Leg], track: float) -> DriveFinding | None:
    """Find wide tyres that are dragged across the floor: a spin falls short, a curve goes too far, a straight is one.

    Wheels of different radii curve in a straight, too; a wrong radius or track changes spin and curve alike.
    """
    straight, spin, curve = (leg for leg in legs if not leg.hard)
    if not spin.commanded_turn or not curve.commanded_turn:
        return None
    by_spin, by_curve = (leg.cruise.turn / leg.commanded_turn for leg in (spin, curve))
    veers = abs(straight.cruise.turn) * track > _STRAIGHT * abs(straight.cruise.forward)
    if veers or by_spin <= 0.0 or by_curve < (1.0 + _SCRUB) * by_spin:
        return None
    return DriveFinding(
        "caster_scrub",
        f"a turn on the spot reaches {by_spin:.1%} of the command and a curve {by_curve:.1%}, while the robot drives "
        "straight: wide tyres of casters or wheels are dragged sideways over the floor. Give them contacts of a few "
        "millimetres (a narrow cylinder in the middle of the tyre), as trundle's USD has; less friction of the casters "
        "helps a little",
        measured=by_curve / by_spin - 1.0,
    )


def _sizes(drive: DifferentialDrive, left: Wheel, right: Wheel, radius: float, track: float) -> list[DriveFinding]:
    findings: list[DriveFinding] = []
    if abs(left.radius - right.radius) > TOLERANCE * radius:
        findings.append(
            DriveFinding(
                "unequal_wheels",
                f"the wheels' effective radii are {left.radius:.4f} m on the left and {right.radius:.4f} m on the "
                "right: commanded to go straight, the robot curves. Check the wheels' colliders and their load",
            )
        )
    far = drive.wheel_radius / radius - 1.0
    if abs(far) > TOLERANCE:
        less = "short of" if far > 0.0 else "farther than"
        share = abs(1.0 / (1.0 + far) - 1.0)
        findings.append(
            DriveFinding(
                "wheel_radius",
                f"wheel_radius is configured as {drive.wheel_radius:g} m, but is effectively {radius:.4f} m: "
                f"the robot drives {share:.0%} {less} the command. Set it to {radius:.4f}",
                drive.wheel_radius,
                radius,
            )
        )
    over = drive.track_width / track - 1.0
    if abs(over) > TOLERANCE:
        findings.append(
            DriveFinding(
                "track_width",
                f"track_width is configured as {drive.track_width:g} m, but is effectively {track:.4f} m: "
                f"the robot turns {abs(over):.0%} too {'far' if over > 0.0 else 'little'}. Set it to {track:.4f}",
                drive.track_width,
                track,
            )
        )
    return findings


def _stopped(finding: DriveFinding, tracking: float | None = None) -> DriveCheck:
    return DriveCheck(None, None, None, None, None, tracking, (finding,))


def _still_wheels(drive: DifferentialDrive, tracking: float) -> DriveFinding:
    return DriveFinding(
        "wheels_do_not_turn",
        f"{drive.left_joint} and {drive.right_joint} reach {tracking:.1%} of the commanded speed"
        f"{_degrees(tracking)}. Check that they are the drive's joints, and that their drives have damping above 0, "
        "stiffness 0 and enough force",
    )


def _slippery(hard: float, gentle: float) -> DriveFinding:
    unsure = ", too much to measure the radius and the track" if gentle > SLIP_TOLERANCE else ""
    return DriveFinding(
        "slip",
        f"the wheels lose {hard:.0%} of their travel at the maximum acceleration and {gentle:.0%} at a small one"
        f"{unsure}: the floor is slippery, or too little weight is on the drive wheels. Lower the robot's "
        "accelerations, or raise the friction of wheels and floor",
        measured=hard,
    )


def _wrong_speed(tracking: float) -> DriveFinding:
    return DriveFinding(
        "wheel_speed",
        f"the wheels turn at {tracking:.0%} of the commanded speed{_degrees(tracking)}: check the damping "
        "and the maximum force of their drives, and max_wheel_speed",
        measured=tracking,
    )


def _no_traction(name: str, wheel: Wheel, drive: DifferentialDrive) -> DriveFinding:
    return DriveFinding(
        "does_not_move",
        f"{name} turns, but hardly moves the robot (an effective radius of {wheel.radius:.4f} m instead of "
        f"{drive.wheel_radius:g} m): the wheel does not touch the floor, has no friction, or is not a drive wheel",
        drive.wheel_radius,
        wheel.radius,
    )


def _held_heading(drive: DifferentialDrive) -> DriveFinding:
    return DriveFinding(
        "does_not_turn",
        f"{drive.left_joint} and {drive.right_joint} turn against each other, but the robot hardly turns: something "
        "holds its heading, such as steered or fixed wheels: a car-like robot is not a differential drive",
    )


def _degrees(tracking: float) -> str:
    """Return the likely cause if the speeds are off by the number of degrees in a radian; else nothing."""
    for factor, words in (
        (math.radians(1.0), "degrees used as radians"),
        (math.degrees(1.0), "radians used as degrees"),
    ):
        if abs(tracking / factor - 1.0) < 0.1:
            return f" ({words} somewhere)"
    return ""

"""Whether a robot drives as it is configured: its wheels' radius, track, order, signs and slip, from its motion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from trundle.doctor.drive_legs import Leg, drive_legs
from trundle.doctor.wheel_fit import Wheel, fit_wheels
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
    "slip",
    "wheel_speed",
    "wheels_do_not_turn",
    "does_not_move",
    "does_not_turn",
    "contact",
]

TOLERANCE = 0.02
"""A configured value that is farther off than this share of the true one is called wrong."""

SLIP_TOLERANCE = 0.05
"""From this share of lost wheel travel on, a floor is called slippery."""

_TURNS = 0.02
"""Wheels that reach less than this share of the commanded speed do not turn."""

_MOVES = 0.1
"""A wheel whose effective radius is less than this share of the configured one does not move the robot; nor do wheels
turn it that turn it by less than this share of what they should.
"""


@dataclass(frozen=True, slots=True)
class DriveFinding:
    """Something that is wrong with a robot's drive.

    Attributes:
        kind: What is wrong.
        message: It in words, with what to do.
        configured: The value that is configured, where there is one.
        measured: What it should be.
    """

    kind: Kind
    message: str
    configured: float | None = None
    measured: float | None = None


@dataclass(frozen=True, slots=True)
class DriveCheck:
    """What a robot's motion tells of its drive.

    Attributes:
        wheel_radius: Effective, the mean of both wheels [m]; none where the robot did not move.
        track_width: Effective [m]; none where the robot did not move.
        slip: Share of the wheels' travel that is lost from rest at the robot's largest acceleration until one second
            after it, straight on or turning, the greater; none where the robot did not move.
        slip_gentle: The same at a small acceleration. Slip is what grows between the two.
        wheel_radii: Effective, (left, right) [m].
        wheel_tracking: Speed of the wheels as a share of the commanded speed, while that is constant.
        findings: What is wrong; empty where all is as configured. Where the robot slips at a small acceleration too,
            its radius and track are not judged.
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

    The radius is what the wheels roll when nothing changes any more after a gentle start, so that slip has no part in
    it; slip is what is lost on the way to that, at a small and at the largest acceleration. It takes 3 m of free, level
    floor ahead of `start` and 1.5 m to its left.

    Args:
        simulator: What moves the robot.
        configured: The drive that commands are computed with; none means that of the simulator's robot.
        start: Where to start, map frame.

    Raises:
        SimulationError: If the simulator breaks down.
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
    if gentle <= SLIP_TOLERANCE:
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


def _sizes(drive: DifferentialDrive, left: Wheel, right: Wheel, radius: float, track: float) -> list[DriveFinding]:
    findings: list[DriveFinding] = []
    if abs(left.radius - right.radius) > TOLERANCE * radius:
        findings.append(
            DriveFinding(
                "unequal_wheels",
                f"the wheels roll as with radii of {left.radius:.4f} m on the left and {right.radius:.4f} m on the "
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
                f"wheel_radius is configured as {drive.wheel_radius:g} m, and the robot rolls as with {radius:.4f} m: "
                f"it drives {share:.0%} {less} the command. Set it to {radius:.4f}",
                drive.wheel_radius,
                radius,
            )
        )
    over = drive.track_width / track - 1.0
    if abs(over) > TOLERANCE:
        findings.append(
            DriveFinding(
                "track_width",
                f"track_width is configured as {drive.track_width:g} m, and the robot turns as with {track:.4f} m: by "
                f"that it turns {abs(over):.0%} too {'far' if over > 0.0 else 'little'}. Set it to {track:.4f}",
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
    unsure = ", too much to tell the radius and the track" if gentle > SLIP_TOLERANCE else ""
    return DriveFinding(
        "slip",
        f"the wheels lose {hard:.0%} of their travel at the largest acceleration and {gentle:.0%} at a small one"
        f"{unsure}: the floor is slippery, or too little weight is on the drive wheels. Lower the robot's "
        "accelerations, or raise the friction of wheels and floor",
        measured=hard,
    )


def _wrong_speed(tracking: float) -> DriveFinding:
    return DriveFinding(
        "wheel_speed",
        f"the wheels turn at {tracking:.0%} of the commanded speed{_degrees(tracking)}: check the damping "
        "and the largest force of their drives, and max_wheel_speed",
        measured=tracking,
    )


def _no_traction(name: str, wheel: Wheel, drive: DifferentialDrive) -> DriveFinding:
    return DriveFinding(
        "does_not_move",
        f"{name} turns, and the robot hardly moves by it (as with a radius of {wheel.radius:.4f} m instead of "
        f"{drive.wheel_radius:g} m): the wheel does not touch the floor, has no friction, or is not a drive wheel",
        drive.wheel_radius,
        wheel.radius,
    )


def _held_heading(drive: DifferentialDrive) -> DriveFinding:
    return DriveFinding(
        "does_not_turn",
        f"{drive.left_joint} and {drive.right_joint} turn against each other, and the robot hardly turns: something "
        "holds its heading. Steered or fixed wheels beside them do: a car-like robot is no differential drive",
    )


def _degrees(tracking: float) -> str:
    """The likely cause where the speeds are off by the number of degrees in a radian."""
    for factor, words in ((math.radians(1.0), "degrees taken for radians"), (math.degrees(1.0), "radians for degrees")):
        if abs(tracking / factor - 1.0) < 0.1:
            return f" ({words} somewhere)"
    return ""

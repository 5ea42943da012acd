"""Checks that a robot's centre of mass is supported, and explains why it tips over if not."""

from __future__ import annotations

from trundle.robots.robot import Robot


def describe_imbalance(robot: Robot) -> str:
    """Explain why a robot tips over, and what to add."""
    x, y = _center_of_mass(robot)
    carried = [wheel.x for wheel in robot.drive.wheels] + [caster.x - caster.trail for caster in robot.casters]
    first, last = min(carried), max(carried)
    begin = f"the robot {robot.name!r} tips over: its wheels and casters do not support it"
    if first < x < last:
        return f"{begin}: check body.center_of_mass, which is at ({x:.3g}, {y:.3g}) m, and where its casters are"
    front = x >= last
    reach = robot.outline[:, 0].max() if front else robot.outline[:, 0].min()
    where, at = ("in front of", max(reach * 0.8, x)) if front else ("behind", min(reach * 0.8, x))
    what = "wheels and casters" if robot.casters else "wheels, and it has no casters"
    return (
        f"{begin}: its centre of mass (body.center_of_mass, x {x:.3g} m) is {where} all of its {what}. Add one there, "
        f"for example casters: [{{x: {at:.3g}, y: 0, radius: {max(0.005, robot.body.clearance / 2.0):.3g}}}]"
    )


def _center_of_mass(robot: Robot) -> tuple[float, float]:
    if robot.body.center_of_mass is not None:
        return robot.body.center_of_mass[0], robot.body.center_of_mass[1]
    low, high = robot.outline.min(axis=0), robot.outline.max(axis=0)
    return float(low[0] + high[0]) / 2.0, float(low[1] + high[1]) / 2.0

"""Findings grouped for display: those of one kind with one fix, and separately those too small for the robot."""

from __future__ import annotations

from typing import NamedTuple

from trundle.maps.check.finding import Finding

LEAST_ROBOT_AREA = 0.024
"""Floor [m²] that the smallest robot of the catalogue stands on, a TurtleBot3 Burger."""

Group = list[Finding]


class Groups(NamedTuple):
    """Findings grouped for display.

    Attributes:
        noticed: Those of one severity, kind and fix, the worst first, each group the largest first.
        small: Free areas where the robot could not stand, and so does not need.
    """

    noticed: list[Group]
    small: Group


def group_findings(findings: tuple[Finding, ...], robot_area: float | None = None) -> Groups:
    """Group findings.

    Args:
        findings: As a report has them.
        robot_area: Area of the robot's footprint [m²]; none means the smallest robot's.
    """
    least = LEAST_ROBOT_AREA if robot_area is None else robot_area
    groups: dict[tuple[str, str, str], Group] = {}
    small: Group = []
    for finding in findings:
        if _is_floor(finding) and finding.area_m2 is not None and finding.area_m2 < least:
            small.append(finding)
        else:
            groups.setdefault((finding.severity, finding.kind, finding.fix), []).append(finding)
    return Groups(list(groups.values()), small)


def _is_floor(finding: Finding) -> bool:
    """Whether a finding is about a free area: specks of free cells are remarks, and of other cells warnings."""
    return finding.kind == "island" or (finding.kind == "speckle" and finding.severity == "info")


def tell_small(small: Group) -> str:
    """One line for the areas that are too small for the robot to notice."""
    largest = max(finding.area_m2 or 0.0 for finding in small)
    what = "free area" if len(small) == 1 else "free areas"
    return f"too small for the robot to notice: {len(small)} {what} that cannot be reached, of up to {largest:.2g} m²"

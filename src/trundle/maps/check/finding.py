"""Results of a map check: findings, each with its severity, its place and its fix, and their grouping for display."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias, get_args

from trundle.maps.grid import OccupancyGrid

Kind: TypeAlias = Literal[
    "yaml",
    "unknown_loads_free",
    "thresholds_inverted",
    "resolution",
    "half_cell",
    "flipped",
    "rotated",
    "shifted",
    "negated",
    "mismatch",
    "missing_obstacle",
    "phantom_obstacle",
    "yaw_ignored",
    "unknown_hole",
    "leak",
    "island",
    "speckle",
    "narrow_door",
    "disconnected",
    "unseen",
]
"""What is wrong with a map; the table in docs/maps.md explains each."""

Severity: TypeAlias = Literal["error", "warning", "info"]
"""How bad a finding is."""

KINDS: tuple[Kind, ...] = get_args(Kind)
"""Every `Kind`."""

PLACEMENT_KINDS: tuple[Kind, ...] = ("half_cell", "flipped", "rotated", "shifted")
"""The kinds that need a world to compare with."""

MOST_A_KIND = 10_000
"""Findings of a kind that are listed, as a noisy map may have many; the rest are summed up in one."""

LEAST_ROBOT_AREA = 0.024
"""Floor [m²] that the smallest robot of the catalogue stands on, a TurtleBot3 Burger."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One problem of a map, or a possible one.

    Attributes:
        kind: The kind of problem.
        severity: "error" where the map means something else than it should, "warning" where a robot will have trouble
            or the map is incomplete, "info" for what is worth knowing.
        message: The problem, with its numbers.
        where: Its place (x, y) [m] in the map frame, or None.
        fix: What to do about it.
        area_m2: Its area [m²], or None.
    """

    kind: Kind
    severity: Severity
    message: str
    where: tuple[float, float] | None
    fix: str
    area_m2: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class MapReport:
    """The findings of a map check.

    Attributes:
        findings: Errors first, then warnings, then remarks.
        unverified: Kinds that could not be checked, because there is no world to compare with or it does not fit.
        ambiguous: Kinds that the world's symmetry hides: it looks the same with and without them.
        remarks: Why something is unverified or ambiguous.
        grid: The map as it was meant to be read, or None where it could not be read.
        corrected: The map with every certain correction, or None where there is none.
        corrected_kinds: The kinds that were corrected.
    """

    findings: tuple[Finding, ...]
    unverified: tuple[Kind, ...] = ()
    ambiguous: tuple[Kind, ...] = ()
    remarks: tuple[str, ...] = ()
    grid: OccupancyGrid | None = None
    corrected: OccupancyGrid | None = None
    corrected_kinds: tuple[Kind, ...] = ()

    @property
    def has_errors(self) -> bool:
        """Whether an error is among the findings."""
        return any(finding.severity == "error" for finding in self.findings)

    def kinds(self) -> set[Kind]:
        """Return the kinds that were found."""
        return {finding.kind for finding in self.findings}


def by_severity(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Sort findings: errors, warnings, remarks; in each the kinds in their order."""
    severities: tuple[Severity, ...] = get_args(Severity)
    return tuple(sorted(findings, key=lambda item: (severities.index(item.severity), KINDS.index(item.kind))))


Group = list[Finding]


class Groups(NamedTuple):
    """Findings grouped for display.

    Attributes:
        noticed: Findings of one severity, kind and fix, the worst first, each group the largest first.
        small: Free areas where the robot could not stand, and so does not need.
    """

    noticed: list[Group]
    small: Group


def group_findings(findings: tuple[Finding, ...], robot_area: float | None = None) -> Groups:
    """Group findings.

    Args:
        findings: The findings of a report.
        robot_area: Area of the robot's footprint [m²]. If None, it is the smallest robot's.
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
    """Return whether a finding is about a free area: specks of free cells are remarks, and of other cells warnings."""
    return finding.kind == "island" or (finding.kind == "speckle" and finding.severity == "info")


def tell_small(small: Group) -> str:
    """Return one line for the areas that are too small for the robot to notice."""
    largest = max(finding.area_m2 or 0.0 for finding in small)
    what = "free area" if len(small) == 1 else "free areas"
    return f"too small for the robot to notice: {len(small)} {what} that cannot be reached, of up to {largest:.2g} m²"

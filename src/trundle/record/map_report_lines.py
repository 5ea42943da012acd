"""A map's report as lines of text: the most important first, limited to one screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trundle.maps.check import Finding, MapReport
    from trundle.maps.check.finding import Group

MOST_LINES = 15
"""Maximum number of lines, unless all findings are requested."""

_PLACES = 3  # listed per group


def tell_report(title: str, report: MapReport, robot_area: float | None, *, most: int | None) -> list[str]:
    """Return the report's lines.

    Args:
        title: Title of the map.
        report: The findings.
        robot_area: Area of the robot's footprint [m²]; smaller free areas are listed last. By default, it is that
            of the smallest robot.
        most: Maximum number of lines. If None, every finding is listed.
    """
    from trundle.maps.check.finding import group_findings, tell_small
    from trundle.record.map_report import count_by_severity

    first, last = f"{title}: {count_by_severity(report)}", _unverified_lines(report)
    if most is None:
        return [first, *(line for finding in report.findings for line in _tell_finding(finding)), *last]
    groups, small = group_findings(report.findings, robot_area)
    if small:
        last = [f"{tell_small(small)}; --all lists them", *last]
    return [first, *_tell_groups(groups, most - 1 - len(last)), *last]


def _tell_finding(finding: Finding) -> list[str]:
    where = f" at {_place(finding)}" if finding.where else ""
    return [f"{finding.severity}: {finding.kind}{where}: {finding.message}", f"    fix: {finding.fix}"]


def _tell_groups(groups: list[Group], room: int) -> list[str]:
    """Return two lines per group if there is room: fixes are dropped from the least severe first."""
    listed = len(groups) if len(groups) <= room else room - 1
    spare = room - listed - (listed < len(groups))
    lines: list[str] = []
    for number, group in enumerate(groups[:listed]):
        what, fix = _tell_group(group)
        lines += [what, fix] if number < spare else [what]
    if listed < len(groups):
        rest = ", ".join(dict.fromkeys(group[0].kind for group in groups[listed:]))
        lines.append(f"and more: {rest}; --all lists them")
    return lines


def _tell_group(group: Group) -> tuple[str, str]:
    what, fix = _tell_finding(group[0])
    if len(group) == 1:
        return what, fix
    others = [_place(finding) for finding in group[1:] if finding.where][: _PLACES - 1]
    rest = len(group) - 1 - len(others)
    places = f"also at {', '.join(others)}" if others else ""
    more = f"{rest} more" if rest else ""
    return f"{what}; {len(group)} in all, {' and '.join(filter(None, (places, more)))}", fix


def _place(finding: Finding) -> str:
    return "nowhere" if finding.where is None else f"({finding.where[0]:.2f}, {finding.where[1]:.2f})"


def _unverified_lines(report: MapReport) -> list[str]:
    """Return which kinds could not be checked, and why; a reason that begins with the kinds stands alone."""
    lines: list[str] = []
    remarks = list(report.remarks)
    for name, kinds in (("unverified", report.unverified), ("ambiguous", report.ambiguous)):
        if kinds:
            listed = ", ".join(kinds)
            why = next((remark for remark in remarks if remark.startswith(f"{listed}: ")), None)
            if why is not None:
                remarks.remove(why)
            lines.append(f"{name}: {why or listed}")
    return [*lines, *(f"    {remark}" for remark in remarks)]

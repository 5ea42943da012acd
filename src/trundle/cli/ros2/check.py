"""`trundle ros2 check`: what of ROS 2 is reachable, and what to do about the rest."""

from __future__ import annotations

from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli.ros2 import network
from trundle.cli.shared import options, output
from trundle.cli.shared.termination import ends_as_by_ctrl_c
from trundle.errors import InputError, TrundleError

_MOST_WAIT_S = 600.0

app = App(
    name="check",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle ros2 check\n"
        "  trundle ros2 check --transport rclpy --wait 10\n"
        "  trundle ros2 check --domain 7 --range subnet --json"
    ),
)


@app.default
def check(
    *,
    at: network.NetworkOptions = network.DEFAULTS,
    wait: Annotated[
        float, Parameter(name="--wait", metavar="SECONDS", help="How long to listen for other programs [s].")
    ] = 3.0,
    json: options.Json = False,
    quiet: Annotated[bool, Parameter(name="--quiet", negative="", help="Print only problems.")] = False,
) -> int:
    """Report what of ROS 2 is reachable: domain, transports, nodes, clock, topics, QoS, types; and what to do.

    Looks as a separate node, which publishes nothing. Exit code 1 if something will not work.
    """
    from trundle.ros2.check import check_network, check_setup
    from trundle.ros2.findings import Finding
    from trundle.ros2.names import Names

    if not 0.0 < wait <= _MOST_WAIT_S:
        raise InputError(f"--wait {wait:g}: give seconds, up to {_MOST_WAIT_S:g}")
    network.check_extra()
    settings = at.read()
    found = list(check_setup(settings, at.ros_python))
    with ends_as_by_ctrl_c():
        try:
            transport = at.open(settings, Names(node="trundle_check"))
        except InputError:
            raise
        except TrundleError as error:
            found.append(Finding("network", "problem", str(error)))
        else:
            try:
                found += check_network(transport, wait_s=wait)
            finally:
                transport.close()
    problems = [finding for finding in found if finding.status == "problem"]
    if json:
        output.print_json({"passed": not problems, "findings": found})
        return 1 if problems else 0
    for finding in problems if quiet else found:
        print(f"{finding.status:<7}  {finding.about:<12}  {finding.detail}")
        if finding.advice:
            print(f"{'':7}  {'':12}  -> {finding.advice}")
    return 1 if problems else 0

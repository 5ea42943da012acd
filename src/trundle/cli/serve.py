"""`trundle serve`: a page in the browser, where runs are set up, watched and driven."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import browser, isaac, nav2, options, output, scenario_options, sources

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trundle.mission import Mission, Observer

app = App(
    name="serve",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle serve\n"
        "  trundle serve office --robot jackal --controller mppi\n"
        "  trundle serve map.yaml --port 9000 --no-open\n"
        "From another machine: ssh -L 8765:localhost:8765 HOST trundle serve --no-open"
    ),
)


@app.default
def serve(
    source: str = "warehouse",
    /,
    *,
    given: scenario_options.ScenarioOptions = scenario_options.DEFAULTS,
    host: Annotated[str, Parameter(name="--host")] = "127.0.0.1",
    port: Annotated[options.Integer | None, Parameter(name="--port")] = None,
    open_: Annotated[bool, Parameter(name="--open", negative="--no-open")] = True,
    speed: options.FirstSpeed = "1",
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Open a page in the browser: pick a world, a robot, a start and a goal; watch, steer and drive by hand.

    Prints the page's address, whose token lets one in. A robot that has arrived waits for the next goal, until the
    page ends its run. Every run is recorded in a folder under runs. Ctrl-C ends serve.

    Args:
        source: What the page begins with: a world by name, the YAML of a map or of a scenario, or a world's file.
        host: Address to listen on; the default lets only this machine in. 0.0.0.0 lets in whoever can reach this
            machine and has the address; the connection is not encrypted.
        port: Port to listen on; default: 8765, or a free one where that is taken.
        open_: Open the page in the browser, where there is one.
    """
    from trundle.record.run_folder import record_failure
    from trundle.serve.run_service import RunService

    factor = options.parse_speed(speed)
    told = nav2.Nav2Report()
    # Without lidars the robot sees no dropped box.
    base = given.make(source, told, instead={} if sources.is_written(source) else {"lidar": True})
    told.tell(quiet=quiet)
    with ExitStack() as opened:
        opened.enter_context(isaac.start_for(base))
        page = opened.enter_context(browser.serving(base, source=source, host=host, port=port))
        service = opened.enter_context(RunService(page.hub, base, _record, record_failure, speed=factor, waits=True))
        service.preview(base)
        if json:
            output.print_json_line({"address": page.server.address, **told.facts})
        else:
            print(page.server.address, flush=True)
        browser.advise(page, opens=open_, quiet=quiet or json)
        service.serve()
    return 0


def _record(mission: Mission, opened: ExitStack) -> tuple[Sequence[Observer], Path | None]:
    from trundle.record.run_folder import RunFolder

    folder = opened.enter_context(RunFolder(name=mission.scenario.title, scenario=mission.scenario, video=False))
    return [folder], folder.path

"""Build real ROS 2 environments for tests, without a ROS installation: ros2_env.py [DISTRO …].

Each has rclpy with Fast DDS, the standard messages and those of tests/ros2/interfaces, for a Python 3.12 found here.
They lie in the user's cache and are built once for each recipe: the pinned wheels in tests/ros2/requirements, the
definitions, and ros2_interfaces.py. `--describe` builds nothing: it prints JSON with the Python and the variables for
it, or with the reason why there is none. Exit status 1 where an environment could not be built.
"""

from __future__ import annotations

import argparse
import contextlib
import fcntl
import functools
import hashlib
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TextIO

DISTROS = ("jazzy", "kilted")
HERE = Path(__file__).resolve().parent
TESTS = HERE.parent / "tests" / "ros2"
BUILDER = HERE / "ros2_interfaces.py"

CHECK = """import rclpy, nav2_msgs.action, nav2_msgs.srv, simulation_interfaces.srv, tf2_msgs.msg, map_msgs.msg
from rclpy.node import Node
rclpy.init()
node = Node("check")
node.create_publisher(tf2_msgs.msg.TFMessage, "check", 1)
node.create_service(simulation_interfaces.srv.StepSimulation, "check", lambda request, response: response)
node.create_client(nav2_msgs.srv.ClearEntireCostmap, "check_too")
rclpy.shutdown()"""


class UnavailableError(Exception):
    """Why there can be no environment here, in one line."""


def main() -> int:
    """Read the command line and do what it says."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("distros", nargs="*", metavar="DISTRO", help=f"of {', '.join(DISTROS)}; default: all")
    parser.add_argument("--describe", action="store_true", help="print the environments as JSON; build nothing")
    options = parser.parse_args()
    distros = options.distros or DISTROS
    if unknown := sorted({*distros}.difference(DISTROS)):
        parser.error(f"unknown distribution {', '.join(unknown)}; choose of {', '.join(DISTROS)}")
    if options.describe:
        print(json.dumps({distro: describe(distro) for distro in distros}))
        return 0
    return max([build_or_explain(distro) for distro in distros])


def folder() -> Path:
    """Where the environments of this recipe lie."""
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache, "trundle", "ros2", recipe())


@functools.cache
def recipe() -> str:
    """A hash of all that goes into the environments."""
    digest = hashlib.sha256(f"{platform.machine()} {platform.libc_ver()}".encode())
    definitions = sorted(path for path in (TESTS / "interfaces").rglob("*") if path.is_file())
    for path in (BUILDER, *sorted((TESTS / "requirements").glob("*.txt")), *definitions):
        digest.update(f"{path.relative_to(HERE.parent)}\0".encode() + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def describe(distro: str) -> dict[str, object]:
    """The Python and the environment variables of an environment, or why it is not there."""
    prefix = folder() / distro
    if prefix.is_dir():
        return {"python": str(prefix / "bin" / "python"), "env": environment(prefix, distro)}
    reason = "it is not built: run make test-ros2"
    with contextlib.suppress(OSError):
        reason = failure_of(distro).read_text(encoding="utf-8").strip()
    return {"reason": f"no ROS 2 {distro.capitalize()}: {reason}"}


def environment(prefix: Path, distro: str) -> dict[str, str]:
    """What a shell has after sourcing ROS; the wheels' own start would run the interpreter twice."""
    libraries = [prefix / "lib", *sorted((prefix / "lib" / "python3.12" / "site-packages").glob("ros_*.libs"))]
    return {
        "ROS_DISTRO": distro,
        "ROS_VERSION": "2",
        "AMENT_PREFIX_PATH": str(prefix),
        "LD_LIBRARY_PATH": ":".join(map(str, libraries)),
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
        "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
    }


def failure_of(distro: str) -> Path:
    """The file that keeps why the last build failed."""
    return folder() / f"{distro}.failed"


def build_or_explain(distro: str) -> int:
    """Build an environment unless it is there; on failure say why, and keep that for the tests."""
    prefix = folder() / distro
    try:
        if not prefix.is_dir():
            with locked(distro):
                if not prefix.is_dir():
                    build(distro, prefix)
    except (UnavailableError, OSError) as error:
        reason = " ".join(str(error).split())
        with contextlib.suppress(OSError):
            failure_of(distro).write_text(reason, encoding="utf-8")
        print(f"No ROS 2 {distro.capitalize()} for tests: {reason}", file=sys.stderr)
        return 1
    print(f"ROS 2 {distro.capitalize()}: {prefix}")
    return 0


@contextlib.contextmanager
def locked(distro: str) -> Iterator[None]:
    """Hold the lock of a distribution, so that two runs do not build it at once."""
    folder().mkdir(parents=True, exist_ok=True)
    with (folder() / f"{distro}.lock").open("w", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print(f"{distro}: waiting for another build")
            fcntl.flock(file, fcntl.LOCK_EX)
        yield


def build(distro: str, prefix: Path) -> None:
    """Build an environment beside its place, then move it there: one that is stopped leaves none that seems whole."""
    begin = time.monotonic()
    python = check_tools()
    for left in folder().glob(f".{distro}-*"):
        shutil.rmtree(left, ignore_errors=True)
    work = Path(tempfile.mkdtemp(prefix=f".{distro}-", dir=folder()))
    try:
        log = folder() / f"{distro}.log"
        with log.open("w", encoding="utf-8") as output:
            print(f"{distro}: installing rclpy and its messages", file=sys.stderr)
            install(python, work, TESTS / "requirements" / f"{distro}.txt", output)
            own = {**os.environ, **environment(work, distro), "ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}
            builder = [str(work / "bin" / "python"), str(BUILDER), str(TESTS / "interfaces"), str(work), distro]
            run(builder, "could not build the messages", output, env=own, nice=True)
            run([str(work / "bin" / "python"), "-c", CHECK], "its rclpy does not start", output, env=own)
        # The interpreter that venv makes is a link, and finds its libraries from where it lies.
        work.rename(prefix)
        failure_of(distro).unlink(missing_ok=True)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    print(f"{distro}: built in {time.monotonic() - begin:.0f} s", file=sys.stderr)


def check_tools() -> str:
    """A Python 3.12 that works, where its wheels and a compiler are."""
    if sys.platform != "linux" or platform.machine() != "x86_64":
        raise UnavailableError(f"its wheels are for Linux on x86-64, not for {sys.platform} on {platform.machine()}.")
    for variable, usual in (("CC", "cc"), ("CXX", "c++")):
        if shutil.which(os.environ.get(variable, usual)) is None:
            raise UnavailableError(f"there is no compiler {os.environ.get(variable, usual)}.")
    # Here, for the tests ask with --describe at every start, and this loads all simulators.
    from trundle.testing.isaac import environment

    try:
        return environment.find_python()
    except environment.UnavailableError as error:
        raise UnavailableError(f"{error}.") from error


def install(python: str, prefix: Path, requirements: Path, output: TextIO) -> None:
    """Make an environment and install the pinned wheels."""
    fast = shutil.which("uv")
    create = [python, "-m", "venv", "--clear", *(["--without-pip"] if fast else []), str(prefix)]
    run(create, "could not make an environment", output)
    own = str(prefix / "bin" / "python")
    command = [fast, "pip", "install", "--python", own] if fast else [own, "-m", "pip", "install", "--quiet"]
    # empy comes as source, and needs no more than setuptools.
    run([*command, "--no-deps", "-r", str(requirements)], "could not install the wheels (is there a network?)", output)


def run(
    command: Sequence[str], complaint: str, output: TextIO, *, env: dict[str, str] | None = None, nice: bool = False
) -> None:
    """Run a command whose standard output goes to the log, and what it says as well, where it fails."""
    if nice:
        command = ["nice", *command]
    errors = None if nice else subprocess.PIPE
    done = subprocess.run(command, stdout=output, stderr=errors, env=env, text=True, check=False)
    if done.returncode != 0:
        last = (done.stderr or "").strip().splitlines()[-1:] or [f"exit status {done.returncode}"]
        output.write(done.stderr or "")
        raise UnavailableError(f"{complaint}: {last[0][:200]} ({output.name})")


if __name__ == "__main__":
    sys.exit(main())

"""Install trundle into Isaac Sim's own Python, where nothing that is there may change.

Runs with that Python and its standard library alone: `python.sh scripts/isaac_install.py [--if-missing] SOURCE`, with
SOURCE this folder or a wheel of trundle. Isaac Sim's Python comes with pinned packages, and a `usd-core` beside Kit's
own USD keeps Kit from starting. So trundle goes in without its dependencies, and of these only the light ones that are
missing, each as an addition: pip's own report says before anything is written what it would install, and whatever is
not a pure addition is refused. The simulator, the viewers and the readers of other formats stay out.
"""

# So that the Python of an Isaac Sim that is too old reaches the check of its version.
from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
from importlib import metadata
from pathlib import Path

from check_tools import missing_build_tools

NOT_HERE = {"mujoco"}
"""What trundle imports only where it is used, and does not need in Isaac Sim."""

HARMFUL = {"usd-core", "usd-exchange", "mujoco", "mujoco-core", "newton", "isaacsim"}
"""What must not come in as somebody's dependency."""

_SOURCES = {".py", ".cpp", ".hpp", ".yaml", ".template"}

_ELSEWHERE = {"PIP_TARGET", "PIP_PREFIX", "PIP_ROOT"}

_INSTALL = ("install", "--quiet", "--no-deps")


class InstallError(Exception):
    """Why nothing was installed."""


def canonical(name: str) -> str:
    """A distribution's name as indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def installed() -> dict[str, str]:
    """Name to version of all that this Python has, from a new process: this one may have cached it."""
    listed = run_pip("list", "--format=json", what="list what is installed")
    return {canonical(entry["name"]): entry["version"] for entry in json.loads(listed)}


def run_pip(*arguments: str, what: str) -> str:
    """Run this Python's pip and return what it printed; raise `InstallError` with its last words where it fails."""
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments]
    # Into this Python and nowhere else, whatever the user has set for his own; 0 keeps pip out of his folder too.
    kept = {name: value for name, value in os.environ.items() if name not in _ELSEWHERE}
    done = subprocess.run(command, env={**kept, "PIP_USER": "0"}, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        if "No module named pip" in done.stderr:
            raise InstallError(f"{sys.executable} has no pip. Add it with: {sys.executable} -m ensurepip")
        raise InstallError(f"could not {what}; pip says:\n{(done.stderr or done.stdout).strip()[-2000:]}")
    return done.stdout


def find_wheel(source: Path, folder: Path) -> Path:
    """The wheel itself, or one built from the folder of trundle's sources."""
    if source.suffix == ".whl":
        if not source.is_file():
            raise InstallError(f"there is no wheel at {source}")
        return source
    if not (source / "pyproject.toml").is_file():
        raise InstallError(f"{source} is neither a wheel nor a folder with trundle's pyproject.toml")
    problems = missing_build_tools()
    if problems:
        raise InstallError(
            "\n".join(problems) + "\nOr build the wheel elsewhere with the same Python version (pip wheel --no-deps .) "
            "and give it: ./isaac.sh install WHEEL"
        )
    print("building trundle's kernels for this Python (about a minute)", flush=True)
    # In a separate folder, so that nothing of this build stays among the sources.
    settings = f"--config-settings=build-dir={folder / 'build'}"
    run_pip("wheel", "--quiet", "--no-deps", settings, "--wheel-dir", str(folder), str(source), what="build trundle")
    return next(folder.glob("trundle-*.whl"))


def light_requirements(wheel: Path, folder: Path) -> list[str]:
    """The wheel's requirements, as pip reads them, without those that it does not need in Isaac Sim."""
    report = folder / "wheel.json"
    run_pip(
        *_INSTALL, "--dry-run", "--force-reinstall", "--report", str(report), str(wheel.resolve()),
        what=f"use {wheel.name}",
    )  # fmt: skip
    (entry,) = json.loads(report.read_text())["install"]
    if canonical(entry["metadata"]["name"]) != "trundle":
        raise InstallError(f"{wheel.name} is a wheel of {entry['metadata']['name']}: give one of trundle")
    required = entry["metadata"].get("requires_dist", [])
    return [line for line in required if "extra ==" not in line and canonical(_name_of(line)) not in NOT_HERE]


def plan_additions(requirements: list[str], have: dict[str, str], folder: Path) -> list[str]:
    """Exact pins of what is missing; nothing is installed yet."""
    if not requirements:
        return []
    constraints, report = folder / "constraints.txt", folder / "report.json"
    constraints.write_text("".join(f"{name}=={version}\n" for name, version in have.items()))
    run_pip(
        "install", "--quiet", "--dry-run", "--report", str(report), "--only-binary", ":all:", "-c", str(constraints),
        *requirements, what="find dependencies that go with what Isaac Sim has pinned",
    )  # fmt: skip
    wanted = {
        canonical(entry["metadata"]["name"]): entry["metadata"]["version"]
        for entry in json.loads(report.read_text())["install"]
    }
    changed = sorted(name for name in wanted if name in have)
    harmful = sorted(name for name in wanted if name in HARMFUL)
    if changed:
        raise InstallError("it would change " + ", ".join(f"{n} {have[n]} to {wanted[n]}" for n in changed))
    if harmful:
        raise InstallError(f"it would bring {', '.join(harmful)}, which does harm in Isaac Sim's Python")
    return [f"{name}=={version}" for name, version in sorted(wanted.items())]


def check_folder() -> None:
    """Refuse a folder of packages that cannot be written: pip would go to the user's own, which other Pythons share."""
    for folder in sorted({sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}):
        if os.path.isdir(folder) and not os.access(folder, os.W_OK):
            raise InstallError(f"{folder} cannot be written: run it as the user who installed Isaac Sim")


def install(source: Path) -> None:
    """Build and plan, then install, and see that nothing else changed."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            check_folder()
            have = installed()
            have.pop("trundle", None)
            wheel = find_wheel(source, folder)
            additions = plan_additions(light_requirements(wheel, folder), have, folder)
        except InstallError as error:
            raise InstallError(f"nothing was changed: {error}") from error
        if additions:
            print(f"adding {', '.join(additions)}", flush=True)
            run_pip(*_INSTALL, "--only-binary", ":all:", *additions, what="add them")
        run_pip(*_INSTALL, "--force-reinstall", str(wheel.resolve()), what="install trundle")
    now = installed()
    changed = sorted(name for name, version in have.items() if now.get(name) != version)
    if changed:
        raise InstallError(f"pip changed {', '.join(changed)}, against its own report: repair Isaac Sim's Python")
    print(f"trundle {now['trundle']} is installed in {sys.executable}")


def is_current(source: Path) -> bool:
    """Whether the version that this folder holds is installed."""
    try:
        have = metadata.version("trundle")
    except metadata.PackageNotFoundError:
        return False
    version = re.search(r'^version = "([^"]+)"', (source / "pyproject.toml").read_text(), re.MULTILINE)
    return version is not None and version.group(1) == have


def remark_on_newer_sources(source: Path) -> None:
    """Report if the sources changed since they were installed; they are not reinstalled, as that takes a minute."""
    there = Path(str(metadata.distribution("trundle").locate_file("trundle/__init__.py")))
    try:
        since = there.stat().st_mtime
        changed = any(path.stat().st_mtime > since for path in (source / "src").rglob("*") if path.suffix in _SOURCES)
    except OSError:
        return
    if changed:
        print("isaac.sh: the sources changed since trundle was installed: ./isaac.sh install takes them over",
              file=sys.stderr)  # fmt: skip


def _name_of(requirement: str) -> str:
    name = re.match(r"[A-Za-z0-9._-]+", requirement)
    return name.group() if name else requirement


def main() -> int:
    """Read the command line; 0 where trundle is installed, 2 where it could not be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=Path, help="this project's folder, or a wheel of trundle")
    parser.add_argument("--if-missing", action="store_true", help="do nothing where this version is installed")
    options = parser.parse_args()
    try:
        if sys.version_info < (3, 11):
            found = ".".join(map(str, sys.version_info[:3]))
            raise InstallError(
                f"{sys.executable} is Python {found}, and trundle needs 3.11 or newer: Isaac Sim 5.1 or newer. Where "
                "there is a newer one, point ISAACSIM_PATH at its folder"
            )
        if options.if_missing and is_current(options.source):
            remark_on_newer_sources(options.source)
        else:
            install(options.source)
    except InstallError as error:
        print(f"isaac.sh: trundle was not installed: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())

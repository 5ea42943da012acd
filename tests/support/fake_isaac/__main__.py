"""Run trundle with a stand-in for Isaac Sim, in a Python that has neither MuJoCo nor usd-core nor a viewer.

python -m support.fake_isaac GENERATION ASSETS KIT_USD VERB …

What must not be imported is refused, whether or not it is installed: MuJoCo and the viewers ever, USD before the
application runs. KIT_USD is a folder with usd-core in it, which is Kit's own USD here; `-` means the installed one.
"""

import importlib.abc
import os
import sys
from pathlib import Path

REFUSED = ("mujoco", "viser", "av", "trimesh", "glfw", "OpenGL")


class Guard(importlib.abc.MetaPathFinder):
    """Refuses imports."""

    fake = None

    def find_spec(self, fullname, path=None, target=None):
        top = fullname.partition(".")[0]
        if top in REFUSED or (top == "pxr" and not (self.fake and self.fake.runs)):
            raise ImportError(f"{fullname} must not be imported here")


def main(generation, assets, kit_usd, *arguments):
    guard = Guard()
    sys.meta_path.insert(0, guard)
    from support.fake_isaac.kit import FakeIsaac
    from trundle.cli.entry import run_command

    kit_path = None if kit_usd == "-" else Path(kit_usd)
    fake = guard.fake = FakeIsaac(int(generation), assets=Path(assets), kit_path=kit_path)
    fake.install_for_good()
    code = run_command(arguments)
    imported = [name for name in sys.modules if name.partition(".")[0] in REFUSED]
    if imported or not fake.app_starts == fake.app_closes == 1:
        sys.exit(f"imported {imported}; started {fake.app_starts} times, closed {fake.app_closes} times")
    sys.exit(code)


if __name__ == "__main__":
    os.environ.pop("TRUNDLE_ISAAC_ASSETS", None)
    main(*sys.argv[1:])

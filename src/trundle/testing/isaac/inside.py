"""Runs a script in the environment: `inside.py KERNELS SECONDS GENERATION ASSETS SCRIPT [ARGUMENT …]`.

This file is run by its path, in a Python that has no trundle: the first thing it does is to make this one importable.
"""

import importlib.abc
import importlib.util
import os
import sys
import traceback
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import TracebackType

PACKAGE = Path(__file__).resolve().parents[2]
ENDED = 3
"""Exit status where the runner ended the script."""


class _Trundle(importlib.abc.MetaPathFinder):
    """Finds this trundle, and the kernels that were compiled for this Python."""

    def __init__(self, kernels: str) -> None:
        self._kernels = kernels

    def find_spec(self, fullname: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if fullname == "trundle":
            where = [str(PACKAGE)]
            return importlib.util.spec_from_file_location(
                fullname, PACKAGE / "__init__.py", submodule_search_locations=where
            )
        if fullname == "trundle._core._kernels":
            return importlib.util.spec_from_file_location(fullname, self._kernels)
        return None


def main(kernels: str, *arguments: str) -> int:
    """Run what the arguments say; return the exit status."""
    sys.meta_path.insert(0, _Trundle(kernels))
    # Where this file lies is no place for modules of scripts.
    sys.path.pop(0)
    if arguments[0] == "--assets":
        from trundle.testing.isaac.assets import write_assets

        write_assets(Path(arguments[1]))
        return 0
    if arguments[0] == "--check":
        exec(arguments[1])
        return 0
    seconds, generation, assets, script, *rest = arguments
    from trundle.testing.isaac.kit import EndedError
    from trundle.testing.isaac.start import install

    install(assets=assets, seconds=float(seconds), generation=int(generation))
    sys.argv = [script, *rest]
    try:
        _run(script)
    except EndedError:
        _end(f"{script} went on after the simulation had ended (--seconds {seconds}), and was ended")
        return ENDED
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return end.code or 0
        print(end.code, file=sys.stderr)
        return 1
    except BaseException as error:  # noqa: BLE001 - as Python does with any
        traceback.print_exception(type(error), error, _of_script(error.__traceback__))
        return 130 if isinstance(error, KeyboardInterrupt) else 1
    return 0


def _run(script: str) -> None:
    """Run a script, or `-m MODULE` by its name, as Python does."""
    if script == "-m":
        import runpy

        module = sys.argv.pop(1)
        sys.path.insert(0, str(Path.cwd()))
        runpy.run_module(module, run_name="__main__", alter_sys=True)
        return
    import types

    main_module = types.ModuleType("__main__")
    main_module.__file__ = script
    main_module.__builtins__ = __builtins__  # type: ignore[attr-defined]
    sys.modules["__main__"] = main_module
    sys.path.insert(0, str(Path(script).resolve().parent))
    code = compile(Path(script).read_bytes(), script, "exec")
    exec(code, vars(main_module))


def _of_script(frames: TracebackType | None) -> TracebackType | None:
    """Leave out the frames of this file, where there are others."""
    rest = frames
    while rest is not None and rest.tb_frame.f_code.co_filename == __file__:
        rest = rest.tb_next
    return rest


def _end(message: str) -> None:
    print(f"trundle.testing.isaac: {message}", file=sys.stderr)


def _tell() -> None:
    """Say which calls did nothing."""
    module = sys.modules.get("trundle.testing.isaac.nothing")
    called = [name for name in getattr(module, "called", ()) if not name.startswith(QUIET)]
    if called:
        # What was called of what came of a call is not said again.
        first = dict.fromkeys(name.partition("()")[0] for name in called)
        _end(f"without Isaac Sim these calls do nothing: {', '.join(first)}")


QUIET = (
    "omni.kit.commands.register", "carb.get_framework", "omni.timeline.ITimeline.set_",
    "omni.timeline.ITimeline.commit",
    "omni.usd.UsdContext.disable_save", "omni.usd.UsdContext.enable_save", "usdrt.",
)  # fmt: skip
"""Calls of NVIDIA's own classes that have no effect on physics."""


if __name__ == "__main__":
    status = main(*sys.argv[1:])
    _tell()
    sys.stdout.flush()
    sys.stderr.flush()
    # Kit's plugins do not expect Python's order of tearing down; nor do PhysX'.
    os._exit(status)

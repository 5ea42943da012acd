"""How the modules of Isaac Sim are found: NVIDIA's sources, the stand-ins, and nothing for the rest of Kit."""

from __future__ import annotations

import importlib
import importlib.abc
import importlib.machinery
import sys
from collections.abc import Mapping
from importlib.metadata import distribution
from pathlib import Path
from types import ModuleType

from trundle.testing.isaac.nothing import Nothing

ROOTS = ("carb", "omni", "usdrt", "Semantics", "nest_asyncio", "osqp")
"""Packages of Kit and of its environment; any module of them can be imported."""

RENAMED = {
    "omni.isaac.kit": "isaacsim",
    "omni.isaac.core.utils.nucleus": "isaacsim.storage.native",
    "isaacsim.core.utils.nucleus": "isaacsim.storage.native",
    "omni.isaac.nucleus": "isaacsim.storage.native",
    "omni.isaac.core.utils": "isaacsim.core.utils",
    "omni.isaac.core.prims": "isaacsim.core.prims",
    "omni.isaac.core.articulations": "isaacsim.core.prims",
    "omni.isaac.core": "isaacsim.core.api",
    "omni.isaac.wheeled_robots": "isaacsim.robot.wheeled_robots",
    "omni.isaac.debug_draw": "isaacsim.util.debug_draw",
}
"""Names of Isaac Sim 4.2 and before, which 5.1 accepts; longer names first."""

FLAT = ("omni.isaac.core.articulations", "omni.isaac.core.prims")
"""Old packages whose modules were one class each: all of them are the present package."""

RENAMED_CLASSES = {
    "omni.isaac.core.articulations": {"Articulation": "SingleArticulation", "ArticulationView": "Articulation"},
    "omni.isaac.core.prims": {
        "XFormPrim": "SingleXFormPrim", "XFormPrimView": "XFormPrim", "RigidPrim": "SingleRigidPrim",
        "RigidPrimView": "RigidPrim", "GeometryPrim": "SingleGeometryPrim", "GeometryPrimView": "GeometryPrim",
    },
}  # fmt: skip
"""Classes whose names changed their meaning with the module's."""

_NEEDS_APPLICATION = ("omni", "pxr", "carb", "usdrt")


class Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds the modules of Isaac Sim.

    Args:
        hidden: Modules that this Isaac Sim does not have.

    Attributes:
        started: Whether SimulationApp runs. Before that nothing but it can be imported.
    """

    def __init__(self, hidden: tuple[str, ...] = ()) -> None:
        self.started = False
        self.hidden = hidden
        self.known: dict[str, Mapping[str, object]] = {}

    def provide(self, name: str, members: Mapping[str, object]) -> None:
        """Give a module these members; any other is NVIDIA's or nothing."""
        self.known[name] = members

    def find_spec(
        self, fullname: str, path: object = None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Find a module."""
        top = fullname.partition(".")[0]
        early = "omni.isaac.kit".startswith(fullname)
        if not self.started and not early and (top in _NEEDS_APPLICATION or fullname.startswith("isaacsim.")):
            raise ModuleNotFoundError(
                f"No module named {fullname!r}: it can only be imported after SimulationApp is created", name=fullname
            )
        if any(fullname == name or fullname.startswith(f"{name}.") for name in self.hidden):
            raise ModuleNotFoundError(f"No module named {fullname!r}", name=fullname)
        if fullname == "isaacsim.sensors":
            raise ModuleNotFoundError(
                f"No module named {fullname!r}: there is no renderer without Isaac Sim", name=fullname
            )
        if top == "torch" and fullname not in self.known:
            raise without_torch(fullname)
        if fullname in self.known or is_open(fullname) or new_name(fullname):
            return importlib.machinery.ModuleSpec(fullname, self, is_package=True)
        if fullname.startswith("isaacsim.") and fullname.count(".") == 1 and not _is_on(path, fullname):
            raise ModuleNotFoundError(
                f"No module named {fullname!r}: without Isaac Sim there are only the packages isaacsim-core and "
                "isaacsim-robot",
                name=fullname,
            )
        return None

    def create_module(self, spec: importlib.machinery.ModuleSpec) -> ModuleType:
        """Make the module; of the modules that do nothing, every attribute is there."""
        renamed = new_name(spec.name)
        if renamed:
            return _Renamed(spec.name, importlib.import_module(renamed))
        if spec.name == "torch":
            return Torch(spec.name)
        if not is_open(spec.name):
            return ModuleType(spec.name)
        module = _Open(spec.name)
        module.finder = self
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Fill the module."""
        vars(module).update(self.known.get(module.__name__, {}))
        module.__path__ = extension_paths() if module.__name__ == "isaacsim" else []
        parent, _, name = module.__name__.rpartition(".")
        if parent in sys.modules:
            setattr(sys.modules[parent], name, module)


class _Open(ModuleType):
    """A module that has everything."""

    finder: Finder

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        full = f"{self.__name__}.{name}"
        # Kit imports its extensions' modules by itself: scripts use omni.timeline after `import omni`.
        if full in self.finder.known:
            return importlib.import_module(full)
        made = Nothing(full)
        setattr(self, name, made)
        return made


class Torch(ModuleType):
    """Stands in for PyTorch, which is not there: NVIDIA's modules import it, though few of their functions use it."""

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        raise without_torch(f"{self.__name__}.{name}")


class _Renamed(ModuleType):
    """An old name of a module."""

    def __init__(self, name: str, real: ModuleType) -> None:
        super().__init__(name)
        self._real = real

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        package = next((package for package in FLAT if f"{self.__name__}.".startswith(f"{package}.")), "")
        return getattr(self._real, RENAMED_CLASSES.get(package, {}).get(name, name))


def without_torch(name: str) -> ModuleNotFoundError:
    """Return the error of a script that uses PyTorch."""
    return ModuleNotFoundError(
        f"No module named 'torch', for {name}: there is no PyTorch without Isaac Sim; use the backend numpy",
        name="torch",
    )


def torch_members() -> dict[str, object]:
    """Return what NVIDIA's modules ask of PyTorch when they are imported."""
    jit = Torch("torch.jit")
    vars(jit)["script"] = lambda function: function
    return {"Tensor": type("Tensor", (), {}), "device": type("device", (), {}), "jit": jit}


def is_open(name: str) -> bool:
    """Return whether a module has any name: those of Kit, those that draw, and compiled parts of extensions."""
    parts = name.split(".")
    return parts[0] in ROOTS or (parts[0] == "isaacsim" and ("bindings" in parts or parts[1:2] in (["util"], ["gui"])))


def new_name(name: str) -> str | None:
    """Return the present name of a module of an old Isaac Sim; None for a present name."""
    for old, new in RENAMED.items():
        if name == old or name.startswith(f"{old}."):
            return new if old in FLAT else new + name.removeprefix(old)
    return None


def extension_paths() -> list[str]:
    """Return the folders of NVIDIA's extensions, as `isaacsim` is spread over them."""
    found: list[str] = []
    for package in ("isaacsim-core", "isaacsim-robot"):
        root = Path(str(distribution(package).locate_file("isaacsim")))
        found += sorted(str(path) for path in root.glob("exts*/isaacsim.*/isaacsim"))
    # Each folder once: both packages are installed in one place.
    return list(dict.fromkeys(found))


def _is_on(path: object, fullname: str) -> bool:
    """Return whether a folder of a package's path has a module."""
    return importlib.machinery.PathFinder.find_spec(fullname, path) is not None  # pyright: ignore[reportArgumentType]

"""The stand-in's modules, made of the signatures, and how Python finds them."""

import importlib.abc
import importlib.machinery
import inspect
import sys
import types
import typing

from support.fake_isaac.behaviour import Behaviour
from support.fake_isaac.refused import Refused, check_shape
from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.sim.isaac import application
from trundle.sim.isaac.signatures import read_signatures

_CREATE = "omni.replicator.core.create"
ADAPTER_MODULES = ("api5", "api6", "contacts", "picture")
PRELUDE = """
from collections.abc import Callable
from typing import Annotated, Any
import numpy as np
import numpy.typing as npt
"""


class FakeIsaac(Behaviour, importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """One process's Isaac Sim.

    Args:
        generation: 5 or 6.
        robot: What drives: the wheels that it really has. Its USD is read for the joints.
        assets: What `get_assets_root_path` gives; none cannot be reached.
        floor: Whether there is a floor under the robot.
        root: Where the articulation's root lies in the robot's prim.
        center: Centre of mass of the root, in its own frame [m].
        pushes: Whether a robot that starts in a solid is pushed out of it.
        kit_path: Where Kit's own USD lies; none means that it is installed.

    Attributes:
        on_draw: Called with the number of every drawing.
        on_step: Called with the number of every physics step.
    """

    def __init__(
        self,
        generation,
        *,
        robot="nova_carter",
        assets=None,
        floor=True,
        kit_path=None,
        root=Pose2D(0.0, 0.0),
        center=(-0.2178, 0.03, 0.281),
        pushes=True,
    ):
        self.kit_path = kit_path
        self.root, self.center, self.pushes = root, center, pushes
        self.generation = generation
        self.robot = Robot.load(robot)
        self.assets = assets
        self.floor = floor
        self.on_draw = self.on_step = lambda _: None
        self.app_starts = self.app_closes = self.draws = self.steps = 0
        self.window_open = False
        self.launch = None
        self.timeline = "stopped"
        self.stage = self.stage_path = None
        self.body = None
        self.world_exists = False
        self.loading = 0
        self.cameras = {}
        self.calls = []
        self.signatures = {entry.name: entry for entry in read_signatures() if generation in entry.generations}
        self.modules = {}
        for entry in self.signatures.values():
            self.modules[entry.name] = self._make_module(entry)

    # The import system's side.

    def install(self, monkeypatch):
        """Make it importable until the test ends, and forget it then."""
        for name in ("ISAAC_PATH", "ISAACSIM_PATH", "EXP_PATH", "TRUNDLE_ISAAC_ASSETS"):
            monkeypatch.delenv(name, raising=False)
        monkeypatch.setattr(sys, "meta_path", [self, *sys.meta_path])
        monkeypatch.setattr(application, "PYTHONS", dict.fromkeys((5, 6), sys.version_info[:2]))
        for name in list(sys.modules):
            if self._is_ours(name) or name in [f"trundle.sim.isaac.{module}" for module in ADAPTER_MODULES]:
                monkeypatch.delitem(sys.modules, name)
        monkeypatch.setitem(sys.modules, "pxr.PhysicsSchemaTools", self._tools())
        return self

    def install_for_good(self):
        """Make it importable in a process that does nothing else."""
        sys.meta_path.insert(0, self)
        sys.modules["pxr.PhysicsSchemaTools"] = self._tools()
        application.PYTHONS.update(dict.fromkeys((5, 6), sys.version_info[:2]))

    def _tools(self):
        tools = types.ModuleType("pxr.PhysicsSchemaTools")
        tools.intToSdfPath = lambda number: self.paths[number]
        return tools

    def uninstall(self):
        """Forget what was imported of it, and what was imported with it."""
        for name in list(sys.modules):
            if self._is_ours(name) or name in [f"trundle.sim.isaac.{module}" for module in ADAPTER_MODULES]:
                del sys.modules[name]

    def find_spec(self, fullname, path=None, target=None):
        if not self._is_ours(fullname):
            return None
        known = any(name == fullname or name.startswith(f"{fullname}.") for name in self.modules)
        # Replicator has it as an attribute, and no module of that name can be imported.
        known = known and fullname != _CREATE
        if not known:
            return None
        if fullname != "isaacsim" and not self.runs:
            raise ImportError(f"{fullname} before SimulationApp runs")
        return importlib.machinery.ModuleSpec(fullname, self, is_package=True)

    def create_module(self, spec):
        return None

    def exec_module(self, module):
        vars(module).update(self.modules.get(module.__name__, {}))
        if f"{module.__name__}.create" == _CREATE:
            module.create = types.SimpleNamespace(**self.modules[_CREATE])

    @staticmethod
    def _is_ours(name):
        return name.partition(".")[0] in ("isaacsim", "omni", "warp")

    def _make_module(self, entry):
        names = {"__name__": entry.name}
        exec(PRELUDE, names)
        for other, made in self.modules.items():
            if f"from {other} import" in entry.imports:
                names.update(made)
        before = set(names)
        exec(f"from __future__ import annotations\n{entry.text}", names)
        made = {}
        for name in set(names) - before - {"annotations"}:
            value = names[name]
            if inspect.isclass(value):
                for attribute, member in list(vars(value).items()):
                    if inspect.isfunction(member) or isinstance(member, classmethod | property):
                        setattr(value, attribute, self._wrap(f"{name}.{attribute}", member, names))
            else:
                value = self._wrap(name, value, names)
            made[name] = value
        return made

    def _wrap(self, name, member, names):
        """Check a call against its signature and the shapes in it, and hand it to the behaviour of the same name."""
        function = member.fget if isinstance(member, property) else getattr(member, "__func__", member)
        signature = inspect.signature(function)
        shapes = {
            key: hint.__metadata__[0]
            for key, hint in typing.get_type_hints(function, names, include_extras=True).items()
            if typing.get_origin(hint) is typing.Annotated
        }
        behaviour = getattr(self, "do_" + name.replace(".", "_").replace("___init__", "_new"))
        first = next(iter(signature.parameters), None)

        def call(*arguments, **keywords):
            bound = signature.bind(*arguments, **keywords)  # a TypeError, as of the real function
            bound.apply_defaults()
            if name != "SimulationApp.__init__" and not self.runs and "close" not in name and "is_" not in name:
                raise Refused(f"{name} when the application does not run")
            for key, shape in shapes.items():
                check_shape(name, key, bound.arguments[key], shape)
            self.calls.append(name)
            values = {key: value for key, value in bound.arguments.items() if key not in ("self", "cls")}
            owner = (bound.arguments[first],) if first == "self" else ()
            return behaviour(*owner, **values)

        call.__name__ = function.__name__
        call.__signature__ = signature
        if isinstance(member, property):
            return property(call)
        return classmethod(call) if isinstance(member, classmethod) else call

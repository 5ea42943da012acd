"""Stand-ins that need no package of NVIDIA."""

from __future__ import annotations

import pytest

pytest.importorskip("pxr")

from trundle.testing.isaac.events import Events
from trundle.testing.isaac.modules import Finder, new_name, torch_members
from trundle.testing.isaac.stage import Context


@pytest.mark.parametrize(
    ("pattern", "names"),
    [
        ("/World/rack_1", ["rack_1"]),
        ("/World/rack_*", ["rack_1", "rack_2"]),
        ("/World/rack_.*", ["rack_1", "rack_2"]),
        ("/World/rack_?", ["rack_1", "rack_2"]),
        ("/World/.*_[2-9]", ["rack_2"]),
        ("/World/rack_[!1]", ["rack_2"]),
        ("/World/(rack|shelf)_1", ["rack_1", "shelf_1"]),
        ("/World/*", ["rack_1", "rack_2", "shelf_1"]),
        ("/World/rack", []),
    ],
)
def test_patterns_of_paths(pattern: str, names: list[str]) -> None:
    context = Context(Events())
    context.new_stage()
    for name in ("rack_1", "rack_2", "shelf_1", "rack_1/shelf_1"):
        context.stage.DefinePrim(f"/World/{name}", "Xform")
    assert context.match(pattern) == [f"/World/{name}" for name in names]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("omni.isaac.core.prims", "isaacsim.core.prims"),
        ("omni.isaac.core.prims.xform_prim", "isaacsim.core.prims"),
        ("omni.isaac.core.articulations.articulation_view", "isaacsim.core.prims"),
        ("omni.isaac.core.objects.cuboid", "isaacsim.core.api.objects.cuboid"),
        ("isaacsim.core.prims", None),
    ],
)
def test_old_names_of_modules(old: str, new: str | None) -> None:
    assert new_name(old) == new


def test_what_needs_pytorch_says_so() -> None:
    finder = Finder()
    finder.provide("torch", torch_members())
    spec = finder.find_spec("torch")
    assert spec is not None
    torch = finder.create_module(spec)
    finder.exec_module(torch)
    assert torch.jit.script(len) is len
    for use in (lambda: torch.zeros(3), lambda: torch.jit.load("policy.pt"), lambda: finder.find_spec("torch.nn")):
        with pytest.raises(ModuleNotFoundError, match="no PyTorch without Isaac Sim; use the backend numpy"):
            use()

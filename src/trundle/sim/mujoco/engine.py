"""A faster import of MuJoCo."""

from __future__ import annotations

import os


def import_engine() -> None:
    """Import MuJoCo without GLFW, which starts another Python to query its own version; a window imports it later.

    MuJoCo reads MUJOCO_GL on import; `trundle.viewer` chooses a driver when a picture is drawn.
    """
    before = os.environ.get("MUJOCO_GL")
    os.environ["MUJOCO_GL"] = "disable"
    try:
        import mujoco  # noqa: F401
    finally:
        if before is None:
            del os.environ["MUJOCO_GL"]
        else:
            os.environ["MUJOCO_GL"] = before

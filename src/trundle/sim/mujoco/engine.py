"""A quicker start of MuJoCo."""

from __future__ import annotations

import os


def import_engine() -> None:
    """Import MuJoCo without GLFW, which starts another Python to ask its own version; a window imports it later.

    MuJoCo reads MUJOCO_GL while it is imported; `trundle.viewer` chooses a driver by itself when a picture is drawn.
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

"""Build packages of ROS 2 messages from text, without CMake: ros2_interfaces.py FOLDER PREFIX DISTRO.

FOLDER holds PACKAGE/msg|srv|action/NAME.msg|srv|action, where a line that ends in #[DISTRO] is for that distribution
only (alone on the first line: the whole file). Runs in the Python of a ROS environment, with its generators (rosidl),
and installs into its PREFIX what rclpy with Fast DDS needs of a package: the C structures, their serialisation, and the
Python classes. There are no C++ classes. Nothing is optimised, and files that include the same large headers are
compiled as one.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Sequence
from pathlib import Path

PACKAGES = ("tf2_msgs", "map_msgs", "geographic_msgs", "nav2_msgs", "simulation_interfaces")
"""Those to build; each uses only those before it and those that have wheels."""

DESCRIPTION, STRUCTURES, PYTHON = "rosidl_generator_type_description", "rosidl_generator_c", "rosidl_generator_py"
HANDLES, FAST, INTROSPECTION = (f"rosidl_typesupport_{kind}" for kind in ("c", "fastrtps_c", "introspection_c"))
GENERATORS = (DESCRIPTION, STRUCTURES, FAST, INTROSPECTION, HANDLES, PYTHON)


def main(folder: Path, prefix: Path, distro: str) -> None:
    for name in PACKAGES:
        # Standard output is the generators'.
        print(f"{distro}: building {name}", file=sys.stderr, flush=True)
        with tempfile.TemporaryDirectory() as temporary:
            Package(name, prefix, Path(temporary)).build(select(folder / name, distro, Path(temporary)))


def select(folder: Path, distro: str, target: Path) -> list[Path]:
    """Write the definitions of one distribution; return their paths below the target folder."""
    chosen: list[Path] = []
    for source in sorted(path for path in folder.rglob("*.*") if path.parent.name in ("msg", "srv", "action")):
        text = of_distro(source.read_text(encoding="utf-8"), distro)
        if text is None:
            continue
        path = source.relative_to(folder)
        (target / path).parent.mkdir(parents=True, exist_ok=True)
        (target / path).write_text(text, encoding="utf-8")
        chosen.append(path)
    return chosen


def of_distro(text: str, distro: str) -> str | None:
    """The definition as one distribution has it; None where it has none."""
    lines = text.splitlines()
    if (whole := re.fullmatch(r"#\[(\w+)\]", lines[0].strip())) is not None and whole[1] != distro:
        return None
    kept: list[str] = []
    for line in lines:
        marked = re.fullmatch(r"(.*?)\s*#\[(\w+)\]", line)
        if marked is None:
            kept.append(line)
        elif marked[2] == distro and marked[1]:
            kept.append(marked[1])
    return "\n".join(kept) + "\n"


class Package:
    """One package of messages on its way into an environment."""

    def __init__(self, name: str, prefix: Path, work: Path) -> None:
        self.name = name
        self.prefix = prefix
        self.share = prefix / "share"
        self.site = Path(sysconfig.get_path("purelib"))
        self.work = work

    def build(self, definitions: Sequence[Path]) -> None:
        """Generate, compile and install."""
        idl = [self._translate(path) for path in definitions]
        self._generate(idl)
        self._compile()
        self._install(definitions, idl)

    def _translate(self, path: Path) -> Path:
        from rosidl_adapter.action import convert_action_to_idl
        from rosidl_adapter.msg import convert_msg_to_idl
        from rosidl_adapter.srv import convert_srv_to_idl

        kinds = {".msg": convert_msg_to_idl, ".srv": convert_srv_to_idl, ".action": convert_action_to_idl}
        kinds[path.suffix](self.work, self.name, path, self.work / path.parent)
        return path.with_suffix(".idl")

    def _generate(self, idl: Sequence[Path]) -> None:
        from rosidl_generator_c import generate_c
        from rosidl_generator_py import generate_py
        from rosidl_generator_type_description import generate_type_hash
        from rosidl_typesupport_c import generate_c as generate_handles
        from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c
        from rosidl_typesupport_introspection_c import generate_c as generate_introspection

        packages = [f"{folder.name}:{folder}" for folder in self.share.iterdir() if any(folder.glob("*/*.idl"))]
        described = [f"{path}:{(self._code(DESCRIPTION) / path).with_suffix('.json')}" for path in idl]
        generate_type_hash(self._arguments(DESCRIPTION, idl, include_paths=packages))
        generate_c(self._arguments(STRUCTURES, idl, type_description_tuples=described))
        generate_typesupport_fastrtps_c(self._arguments(FAST, idl))
        generate_introspection(self._arguments(INTROSPECTION, idl))
        generate_handles(self._arguments(HANDLES, idl), [FAST, INTROSPECTION])
        generate_py(self._arguments(PYTHON, idl), [HANDLES])
        for generator in (STRUCTURES, FAST, INTROSPECTION):
            self._write_export_macros(generator)

    def _code(self, generator: str) -> Path:
        """The folder that a generator writes to; its parent is where files are included from."""
        return self.work / generator / self.name

    def _arguments(self, generator: str, idl: Sequence[Path], **more: object) -> str:
        """A file of arguments for one of the generators."""
        arguments = {
            "package_name": self.name,
            "output_dir": str(self._code(generator)),
            "template_dir": str(self.share / generator / "resource"),
            "idl_tuples": [f"{self.work}:{path}" for path in idl],
            "ros_interface_files": [str(self.work / path) for path in idl],
            "ros_interface_dependencies": [f"{path.parents[1].name}:{path}" for path in self.share.glob("*/*/*.idl")],
            "target_dependencies": [],
            **more,
        }
        file = self.work / f"{generator}.json"
        file.write_text(json.dumps(arguments), encoding="utf-8")
        return str(file)

    def _write_export_macros(self, generator: str) -> None:
        name = f"{generator}__visibility_control.h"
        text = (self.share / generator / "resource" / f"{name}.in").read_text(encoding="utf-8")
        target = self._code(generator) / "msg"
        target.mkdir(parents=True, exist_ok=True)
        filled = text.replace("@PROJECT_NAME@", self.name).replace("@PROJECT_NAME_UPPER@", self.name.upper())
        (target / name).write_text(filled, encoding="utf-8")

    def _compile(self) -> None:
        """Compile the libraries, each with those before it."""
        for generator in (STRUCTURES, FAST, INTROSPECTION, HANDLES):
            self._link(self._library(generator), sorted(self._code(generator).rglob("*.c*")))
        python = sorted(self._code(PYTHON).glob("*/_*_s.c"))
        self._link(self._library(PYTHON), python)
        (self.site / self.name).mkdir(exist_ok=True)
        entry = self._code(PYTHON) / f"_{self.name}_s.ep.{HANDLES}.c"
        self._link(self.site / self.name / f"{self.name}_s__{HANDLES}.so", [entry])

    def _library(self, generator: str) -> Path:
        return self.prefix / "lib" / f"lib{self.name}__{generator}.so"

    def _link(self, library: Path, sources: Sequence[Path]) -> None:
        """Compile the sources into a library, which needs those libraries of the environment whose symbols it uses."""
        import numpy

        if sources[0].suffix == ".cpp":
            # One after the other, nearly all of the time would go into the same headers again and again.
            together = self.work / f"{library.stem}.cpp"
            together.write_text("".join(f'#include "{path}"\n' for path in sources), encoding="utf-8")
            compiler, sources = os.environ.get("CXX", "c++"), [together]
        else:
            compiler = os.environ.get("CC", "cc")
        folders = [*(self.work / generator for generator in GENERATORS), *(self.prefix / "include").iterdir()]
        folders += [self.prefix / "include", Path(sysconfig.get_path("include")), Path(numpy.get_include())]
        used = sorted(path for path in (self.prefix / "lib").glob("lib*.so") if path != library)
        command = [compiler, "-O0", "-w", "-fPIC", "-shared", "-o", str(library), *map(str, sources)]
        command += [f"-I{folder}" for folder in folders]
        command += [f"-L{self.prefix / 'lib'}", "-Wl,--as-needed", "-Wl,--allow-shlib-undefined"]
        command += [f"-l{path.stem[3:]}" for path in used]
        if (status := subprocess.run(command, check=False).returncode) != 0:
            raise SystemExit(f"{self.name}: {compiler} could not build {library.name} (exit status {status}).")

    def _install(self, definitions: Sequence[Path], idl: Sequence[Path]) -> None:
        """Copy the Python classes, the headers, the definitions and their hashes to where ROS looks for them."""
        python = self._code(PYTHON)
        for path in python.rglob("*.py"):
            target = self.site / self.name / path.relative_to(python)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)
        (self.site / self.name / "__init__.py").touch()
        for generator in (STRUCTURES, FAST, INTROSPECTION):
            code, target = self._code(generator), self.prefix / "include" / self.name / self.name
            shutil.copytree(code, target, ignore=_all_but_headers, dirs_exist_ok=True)
        share = self.share / self.name
        for path in (*definitions, *idl):
            (share / path.parent).mkdir(parents=True, exist_ok=True)
            shutil.copy(self.work / path, share / path)
        for path in idl:
            shutil.copy((self._code(DESCRIPTION) / path).with_suffix(".json"), (share / path).with_suffix(".json"))
        index = self.share / "ament_index" / "resource_index"
        (index / "packages" / self.name).touch()
        (index / "rosidl_interfaces" / self.name).write_text(
            "\n".join(map(str, (*definitions, *idl))), encoding="utf-8"
        )


def _all_but_headers(folder: str, names: list[str]) -> list[str]:
    return [name for name in names if not (name.endswith(".h") or Path(folder, name).is_dir())]


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3])

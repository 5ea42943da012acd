"""The texts of Nav2's messages, services and actions, of one distribution, as a transport gives them."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from trundle.messages import Codec, Distro

INTERFACES = Path(__file__).parent / "interfaces"

_EMPTY = "uint8 structure_needs_at_least_one_member\n"

OTHERS = {
    "lifecycle_msgs/msg/State": "uint8 id\nstring label\n",
    "lifecycle_msgs/srv/GetState_Request": _EMPTY,
    "lifecycle_msgs/srv/GetState_Response": "State current_state\n",
    "lifecycle_msgs/msg/Transition": "uint8 id\nstring label\n",
    "lifecycle_msgs/srv/ChangeState_Request": "Transition transition\n",
    "lifecycle_msgs/srv/ChangeState_Response": "bool success\n",
    "rcl_interfaces/srv/ListParameters_Request": "string[] prefixes\nuint64 depth\n",
    "rcl_interfaces/srv/ListParameters_Response": "rcl_interfaces/ListParametersResult result\n",
    "rcl_interfaces/srv/GetParameters_Request": "string[] names\n",
    "rcl_interfaces/srv/GetParameters_Response": "rcl_interfaces/ParameterValue[] values\n",
    "rcl_interfaces/srv/GetParameterTypes_Request": "string[] names\n",
    "rcl_interfaces/srv/GetParameterTypes_Response": "uint8[] types\n",
    "rcl_interfaces/srv/DescribeParameters_Request": "string[] names\n",
    "rcl_interfaces/srv/DescribeParameters_Response": "rcl_interfaces/ParameterDescriptor[] descriptors\n",
    "rcl_interfaces/srv/SetParameters_Request": "rcl_interfaces/Parameter[] parameters\n",
    "rcl_interfaces/srv/SetParameters_Response": "rcl_interfaces/SetParametersResult[] results\n",
    "std_srvs/srv/Trigger_Request": _EMPTY,
    "std_srvs/srv/Trigger_Response": "bool success\nstring message\n",
    "std_srvs/srv/Empty_Request": _EMPTY,
    "std_srvs/srv/Empty_Response": _EMPTY,
    "nav_msgs/srv/GetMap_Request": _EMPTY,
    "nav_msgs/srv/GetMap_Response": "nav_msgs/OccupancyGrid map\n",
    "nav2_msgs/srv/IsPathValid_Request": "nav_msgs/Path path\n",
    "nav2_msgs/srv/IsPathValid_Response": "bool success\nbool is_valid\nint32[] invalid_pose_indices\n",
}
"""Types of packages that have wheels, and one that the built environments lack."""

_SEPARATOR = "\n" + "=" * 80 + "\n"
_PARTS = {"msg": ("",), "srv": ("_Request", "_Response"), "action": ("_Goal", "_Result", "_Feedback")}


@cache
def nav2_codec(distro: Distro) -> Codec:
    """A codec that has these types: it takes a while to make."""
    codec = Codec(distro)
    for name, text in nav2_texts(distro).items():
        if name not in codec:
            codec.register(name, text)
    return codec


@cache
def nav2_texts(distro: str) -> dict[str, str]:
    """The text of each type, with those that it uses."""
    texts = dict(OTHERS)
    for path in sorted(INTERFACES.glob("*_msgs/*/*.*")):
        package, kind = path.parts[-3:-1]
        chosen = _of_distro(path.read_text(encoding="utf-8"), distro)
        for part, text in zip(_PARTS[kind], re.split(r"^---$", chosen, flags=re.MULTILINE), strict=True):
            texts[f"{package}/{kind}/{path.stem}{part}"] = text if text.strip() else _EMPTY
    own = {name.split("/")[2]: name.replace("/msg/", "/") for name in texts if "/msg/" in name}
    for name, text in texts.items():
        texts[name] = re.sub(r"^(\w+)(?=[ \[])", lambda used: own.get(used[1], used[1]), text, flags=re.MULTILINE)
    return {name: _with_parts(name, texts) for name in texts}


def _of_distro(text: str, distro: str) -> str:
    """Without the lines of other distributions; a line of one ends in #[distro]."""
    lines = [re.fullmatch(r"(.*?)\s*(?:#\[(\w+)\])?", line) for line in text.splitlines()]
    return "\n".join(line[1] for line in lines if line is not None and line[2] in (None, distro)) + "\n"


def _with_parts(name: str, texts: dict[str, str]) -> str:
    """A text with those of the types of its package that it uses."""
    found: dict[str, str] = {}
    waiting = [name]
    while waiting:
        for field in re.findall(r"^(\w+/\w+)(?:\[\d*\])? \w+", texts[waiting.pop()], flags=re.MULTILINE):
            used = "/msg/".join(field.split("/"))
            if used in texts and field not in found:
                found[field] = texts[used]
                waiting.append(used)
    sections = [f"MSG: {used}\n{text}" for used, text in found.items()]
    return _SEPARATOR.join([texts[name], *sections])

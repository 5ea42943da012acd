"""What a child reports of the network, as a `Graph`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from trundle.messages import Qos
from trundle.ros2.transport.graph import Endpoint, Graph, Offer


def read_graph(report: Mapping[str, Any]) -> Graph:
    """The graph of a child's report, without what ROS's own tools hide: names with a part that begins with "_"."""
    ours = {full_name(*node) for node in report["ours"]}
    endpoints = [_endpoint(entry, ours) for entry in report["endpoints"] if not _is_hidden(entry["topic"])]
    offers = [_offer(entry, ours) for entry in report["offers"] if not _is_hidden(entry["name"])]
    nodes = sorted({full_name(*node) for node in report["nodes"]})
    return Graph(tuple(node for node in nodes if not _is_hidden(node)), tuple(endpoints), tuple(offers))


def full_name(name: str, namespace: str) -> str:
    """A node's name with its namespace ("/robot/amcl"); "" for one that is not known, as of a program without ROS."""
    if not name or name.startswith(("_NODE_NAME_UNKNOWN_", "_CREATED_BY_BARE_DDS_APP_")):
        return ""
    return f"{namespace.rstrip('/')}/{name}"


def _is_hidden(name: str) -> bool:
    return any(part.startswith("_") for part in name.split("/"))


def _endpoint(entry: Mapping[str, Any], ours: set[str]) -> Endpoint:
    node = full_name(entry["node"], entry["namespace"])
    best_effort, latched = entry["reliability"] == "best_effort", entry["durability"] == "transient_local"
    return Endpoint(
        kind=entry["kind"],
        topic=entry["topic"],
        type_name=entry["type"],
        type_hash=entry["hash"] if entry["hash"].startswith("RIHS") else "",
        qos=Qos(
            int(entry["depth"]),
            "best_effort" if best_effort else "reliable",
            "transient_local" if latched else "volatile",
        ),
        node=node,
        source=entry["gid"] if entry["kind"] == "publisher" else "",
        ours=node in ours,
    )


def _offer(entry: Mapping[str, Any], ours: set[str]) -> Offer:
    node = full_name(entry["node"], entry["namespace"])
    return Offer(entry["kind"], entry["name"], entry["type"], node, node in ours)

"""`run_on_cluster`: gives shards of an evaluation to the nodes of a Ray cluster, and those of a lost node to others."""

from __future__ import annotations

import time
import uuid
from array import array
from collections import deque
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from types import ModuleType
from typing import Any

from trundle.evaluation.cluster.connection import ClusterError, connect
from trundle.evaluation.cluster.node import MakeSource, Node, ShardDone
from trundle.evaluation.store.folder import describe_differences
from trundle.evaluation.store.remote import is_remote
from trundle.files.writing import cannot_write

SHARD = 500
"""Episodes that a node runs before it writes a part; those of a lost node's shard run again."""

_LOOK_S = 2.0
"""Time between two looks for nodes that have joined [s]."""
_PATIENCE_S = 60.0
"""How long a cluster may be without a node [s]: one that is replaced takes a while to start."""
_MOST_LOSSES = 3
"""Nodes that may be lost with one shard, and starts that may fail on one node: more are no accident."""

Shard = Sequence[int]


def run_on_cluster(
    make_source: MakeSource,
    indices: Iterable[int],
    *,
    out: str | Path,
    address: str,
    versions: Mapping[str, str],
    packages: Sequence[str] = (),
    mixed: bool = False,
    shard: int = SHARD,
    workers: int | None = None,
    until: float | None = None,
) -> Generator[ShardDone, None, None]:
    """Run episodes on all nodes of a cluster; their rows are parts in the folder when this yields their counts.

    Each node has one actor, which holds all its CPUs and runs a pool of as many workers. Where the iterator is closed,
    or an exception passes through it, what runs on the cluster ends.

    Args:
        make_source: Makes what runs the episodes on a node, given the number of workers.
        indices: Numbers of the episodes; they are read as nodes get free.
        out: The folder of the evaluation, which all nodes share, or the URI of an object store.
        address: Address of the cluster, or `auto`; see `connect`.
        versions: Versions of the code here; a node with other code is refused.
        packages: Further packages that `versions` lists.
        mixed: Use nodes with other code.
        shard: Episodes that a node gets at a time.
        workers: Worker processes on each node; by default one for each of its CPUs.
        until: When to end, in terms of `time.monotonic` [s]; by default when all is done.

    Raises:
        InputError: If the address is none.
        ClusterError: If the cluster cannot be reached, a node cannot be used, or no node is left.
        MissingExtraError: If a library is not installed here.
    """
    todo = _Todo(iter(indices), shard)
    place = str(out) if is_remote(out) else str(Path(out).absolute())
    with connect(address) as ray, _token(out) as token:
        actors = _Actors(ray, (make_source, place), workers, (token, tuple(packages)))
        while actors.is_busy or (todo and not _is_over(until)):
            actors.start_missing()
            for actor in actors.idle():
                if todo and not _is_over(until):
                    actors.give(actor, todo.take(), until)
            for done in actors.wait(None if mixed else versions):
                if isinstance(done, ShardDone):
                    yield done
                else:
                    todo.put_back(done)


def _is_over(until: float | None) -> bool:
    return until is not None and time.monotonic() >= until


@dataclass(slots=True)
class _Work:
    """A shard, and how many nodes were lost while they had it."""

    shard: Shard
    losses: int = 0


class _Todo:
    """The shards that no node has: true while there is one."""

    def __init__(self, indices: Iterator[int], size: int) -> None:
        self._indices = indices
        self._size = size
        self._ahead: deque[_Work] = deque()

    def __bool__(self) -> bool:
        if not self._ahead:
            shard = array("q", islice(self._indices, self._size))
            self._ahead.extend([_Work(shard)] if shard else [])
        return bool(self._ahead)

    def take(self) -> _Work:
        return self._ahead.popleft()

    def put_back(self, work: _Work) -> None:
        self._ahead.append(work)


@dataclass(slots=True, eq=False)
class _NodeActor:
    """An actor on a node, with what it does now: it starts, has a shard, or is idle."""

    node: str
    name: str
    handle: Any
    is_ready: bool = False
    work: _Work | None = None


@dataclass(slots=True, eq=False)
class _Actors:
    """The actors, at most one on each node."""

    ray: ModuleType
    what: tuple[MakeSource, str]
    workers: int | None
    first_call: tuple[str | None, tuple[str, ...]]
    _by_node: dict[str, _NodeActor] = field(default_factory=dict)
    _waiting: dict[Any, _NodeActor] = field(default_factory=dict)
    _failed_starts: dict[str, int] = field(default_factory=dict)
    _looked: float = -_LOOK_S
    _last_seen: float = field(default_factory=time.monotonic)

    def start_missing(self) -> None:
        """Start an actor on each node that has none, also on nodes that have joined since.

        Raises:
            ClusterError: If there has been no node for a minute.
        """
        now = time.monotonic()
        if now - self._looked < _LOOK_S:
            return
        self._looked = now
        for node in self.ray.nodes():
            cpus = int(node["Resources"].get("CPU", 0))
            if node["Alive"] and cpus >= 1 and node["NodeID"] not in self._by_node:
                self._start(node["NodeID"], f"{node['NodeManagerHostname']} ({node['NodeManagerAddress']})", cpus)
        if self._by_node:
            self._last_seen = now
        elif now - self._last_seen > _PATIENCE_S:
            raise ClusterError(
                "the cluster has no node with a CPU left; the rows of finished shards are kept: give the same command "
                "to continue when it has"
            )

    def idle(self) -> list[_NodeActor]:
        """Return the actors that wait for a shard."""
        return [actor for actor in self._by_node.values() if actor.is_ready and actor.work is None]

    @property
    def is_busy(self) -> bool:
        """Whether an actor has a shard."""
        return any(actor.work is not None for actor in self._by_node.values())

    def give(self, actor: _NodeActor, work: _Work, until: float | None) -> None:
        """Let a node run a shard, or what it can of it until then."""
        actor.work = work
        left_s = None if until is None else max(0.0, until - time.monotonic())
        self._waiting[actor.handle.run.remote(work.shard, left_s)] = actor

    def wait(self, versions: Mapping[str, str] | None) -> Iterator[ShardDone | _Work]:
        """Wait a little for answers: shards that are done, and shards of nodes that were lost.

        Raises:
            ClusterError: If a node cannot be used, or a shard fails.
        """
        if not self._waiting:
            time.sleep(_LOOK_S / 4)
            return
        answers, _ = self.ray.wait(list(self._waiting), timeout=_LOOK_S)
        for answer in answers:
            actor = self._waiting.pop(answer)
            work, actor.work = actor.work, None
            try:
                value = self.ray.get(answer)
            except self.ray.exceptions.RayTaskError as error:
                raise ClusterError(f"on the node {actor.name}: {error.cause}") from error
            except self.ray.exceptions.RayError as error:
                self._lose(actor, error)
                if work is not None:
                    yield self._reassigned(work, actor)
                continue
            if work is not None:
                yield value
            else:
                self._admit(actor, value, versions)

    def _start(self, node: str, name: str, cpus: int) -> None:
        from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy  # pyright: ignore[reportMissingImports]

        strategy = NodeAffinitySchedulingStrategy(node, soft=False)
        options = {"num_cpus": cpus, "scheduling_strategy": strategy, "max_restarts": 0, "max_task_retries": 0}
        handle = (
            self.ray.remote(Node).options(**options).remote(*self.what, uuid.uuid4().hex[:10], self.workers or cpus)
        )
        actor = _NodeActor(node, name, handle)
        self._by_node[node] = actor
        self._waiting[handle.start.remote(*self.first_call)] = actor

    def _admit(self, actor: _NodeActor, found: Mapping[str, str], versions: Mapping[str, str] | None) -> None:
        differences = "" if versions is None else describe_differences(versions, found)
        if differences:
            raise ClusterError(
                f"the node {actor.name} runs other code ({differences}); install the same there, or give --mixed"
            )
        actor.is_ready = True

    def _lose(self, actor: _NodeActor, error: Exception) -> None:
        """Forget an actor; one that cannot start on a node that is alive is not tried for ever."""
        del self._by_node[actor.node]
        self.ray.kill(actor.handle)
        alive = {node["NodeID"] for node in self.ray.nodes() if node["Alive"]}
        if actor.is_ready or actor.node not in alive:
            return
        self._failed_starts[actor.node] = self._failed_starts.get(actor.node, 0) + 1
        if self._failed_starts[actor.node] >= _MOST_LOSSES:
            text = str(error).strip().splitlines()
            raise ClusterError(f"the node {actor.name} cannot be used: {text[-1] if text else error!r}") from error

    def _reassigned(self, work: _Work, actor: _NodeActor) -> _Work:
        work.losses += 1
        if work.losses >= _MOST_LOSSES:
            raise ClusterError(
                f"{_MOST_LOSSES} nodes were lost while they ran the episodes {work.shard[0]} to {work.shard[-1]}, the "
                f"last one {actor.name}; perhaps they need more memory than it has: limits.memory_mb"
            )
        return work


@contextmanager
def _token(out: str | Path) -> Iterator[str | None]:
    """Write a file into the folder by which a node sees that it is the same there."""
    if is_remote(out):
        yield None
        return
    file = Path(out) / f".cluster-{uuid.uuid4().hex}"
    try:
        file.touch()
    except OSError as error:
        raise cannot_write(out, error) from error
    try:
        yield file.name
    finally:
        file.unlink(missing_ok=True)

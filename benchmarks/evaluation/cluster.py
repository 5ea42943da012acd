"""CPU time of the driver for each of a million episodes that do nothing, on a cluster of nodes on this machine.

make test-ray  # installs Ray
python scripts/only_lo.py .venv/bin/python -m benchmarks.evaluation.cluster [--episodes 1000000] [--nodes 2]
"""

import argparse
import hashlib
import os
import resource
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from benchmarks.timing import describe_machine
from ray.cluster_utils import Cluster

from trundle.evaluation.cluster import run_on_cluster
from trundle.evaluation.pool import Done, Pool
from trundle.evaluation.row import Row
from trundle.evaluation.store import Results, Store, code_versions

EMPTY = Row(
    id="",
    mission="0" * 16,
    index=0,
    world="nothing",
    robot="nova_carter",
    planner="auto",
    controller="regulated_pure_pursuit",
    backend="kinematic",
    seed=0,
    outcome="arrived",
)


class Nothing:
    """An episode that ends at once."""

    def setup(self) -> None:
        pass

    def __call__(self, index: int, note: Callable[[Mapping[str, Any]], None]) -> Row:
        return replace(EMPTY, id=hashlib.blake2b(str(index).encode(), digest_size=8).hexdigest(), index=index)


class Source:
    """The pool of a node."""

    def __init__(self, workers: int) -> None:
        self._pool = Pool(Nothing(), workers=workers, deadline_s=60.0, memory_mb=1000.0)

    def rows(self, indices: Iterable[int]) -> Iterator[Row]:
        for done in self._pool.run(indices):
            if not isinstance(done, Done):
                raise SystemExit(f"an episode failed: {done}")
            yield done.value

    def close(self) -> None:
        self._pool.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--episodes", type=int, default=1_000_000)
    parser.add_argument("--nodes", type=int, default=2)
    parser.add_argument("--workers", type=int, default=1, help="on each node")
    options = parser.parse_args()
    os.environ |= {"RAY_NODE_IP_ADDRESS": "127.0.0.1", "PYTHONPATH": str(Path(__file__).parents[2])}
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    for _ in range(options.nodes):
        cluster.add_node(num_cpus=1)
    versions = code_versions()
    with tempfile.TemporaryDirectory() as folder:
        wall, cpu = time.perf_counter(), time.process_time()
        with Store.open(folder, name="n", suite_text="name: n\n", total=options.episodes, versions=versions) as store:
            done = run_on_cluster(
                Source,
                store.pending(()),
                out=folder,
                address=cluster.address,
                versions=versions,
                workers=options.workers,
            )
            count = sum(each.episodes for each in done)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        with Results.open(folder) as results:
            if len(results) != options.episodes:
                raise SystemExit(f"{len(results)} rows of {options.episodes}")
    cluster.shutdown()
    print(describe_machine())
    print(
        f"{count:,} episodes: {1e3 * cpu / count:.4f} ms of the driver's CPU time and {1e3 * wall / count:.3f} ms each"
    )
    print(f"the driver took {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB at most")


if __name__ == "__main__":
    main()

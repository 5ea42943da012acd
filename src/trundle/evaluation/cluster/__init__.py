"""An evaluation on several machines, by Ray: each node runs the local pool on shards, and writes its own parts."""

from trundle.evaluation.cluster.connection import AUTO, ClusterError
from trundle.evaluation.cluster.driver import SHARD, run_on_cluster
from trundle.evaluation.cluster.node import MakeSource, RowSource, ShardDone

__all__ = ["AUTO", "SHARD", "ClusterError", "MakeSource", "RowSource", "ShardDone", "run_on_cluster"]

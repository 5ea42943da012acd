"""A pool of worker processes where a job that crashes, hangs or eats memory costs no other one.

It knows nothing of evaluations: a `Task` and jobs go in, `Done` and `Failed` come out as they end.
"""

from trundle.evaluation.pool.outcome import Done, Failed, Jobs, Note, PoolSetupError, Task
from trundle.evaluation.pool.pool import Pool

__all__ = ["Done", "Failed", "Jobs", "Note", "Pool", "PoolSetupError", "Task"]

"""The folder of an evaluation: rows are written by `Store`, durable when they arrive, and read by `Results`."""

from trundle.evaluation.store.folder import code_versions
from trundle.evaluation.store.results import Results
from trundle.evaluation.store.store import Store

__all__ = ["Results", "Store", "code_versions"]

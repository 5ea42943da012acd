"""The exception of evaluations on a cluster."""

from trundle.errors import TrundleError


class ClusterError(TrundleError):
    """A cluster that cannot be reached or used, or has no nodes left."""

"""Domains of ROS 2 for tests and benchmarks, each used by one of them at a time on this machine."""

from __future__ import annotations

import fcntl
import os
import random
import tempfile
from pathlib import Path

DOMAINS = range(1, 102)
"""Domains above 101 have ports that the system may give to others."""

_claimed: dict[int, int] = {}
"""The open file of each, which is locked."""


def claim_domain() -> int:
    """A domain that no other process has claimed, until `release_domain`, or the end of this process."""
    for domain in random.SystemRandom().sample(DOMAINS, len(DOMAINS)):
        if domain in _claimed:
            continue
        file = os.open(Path(tempfile.gettempdir(), f"trundle-domain-{domain}.lock"), os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(file)
            continue
        _claimed[domain] = file
        return domain
    raise RuntimeError(f"all {len(DOMAINS)} domains are in use: end the tests and benchmarks that run")


def release_domain(domain: int) -> None:
    """Let others have a domain that was claimed here."""
    os.close(_claimed.pop(domain))

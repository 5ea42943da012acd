"""Writing the reports of an evaluation in a separate process, whose memory is free afterwards."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence

from trundle.errors import OutputError
from trundle.guard.process import start_process

_PROGRAM = """
import json, os, signal, sys
signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
os.nice(int(sys.argv[3]))
from trundle.errors import TrundleError
from trundle.evaluation import Evaluation
try:
    Evaluation(sys.argv[1]).write_report(json.loads(sys.argv[2]), apart=False)
except TrundleError as error:
    sys.exit(str(error))
"""

Writer = subprocess.Popen[bytes]
"""What writes a report beside this process."""


def start_writer(folder: str) -> Writer:
    """Start a process that writes the reports of a folder once; what it has to say is dropped."""
    return start_process(_command(folder, None, nice=10))


def write_apart(folder: str, require: Sequence[str] | None) -> None:
    """Write the reports of a folder, and wait for them.

    Args:
        folder: The folder, or the URI of one in an object store.
        require: What to judge by; none means the suite's requirements.

    Raises:
        OutputError: If they cannot be written.
    """
    command = _command(folder, require, nice=0)
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False
    )
    if done.returncode != 0:
        reason = done.stderr.decode(errors="replace").strip() or f"its process ended with {done.returncode}"
        raise OutputError(f"the report of {folder} could not be written: {reason}")


def _command(folder: str, require: Sequence[str] | None, *, nice: int) -> list[str]:
    return [sys.executable, "-c", _PROGRAM, folder, json.dumps(require), str(nice)]

"""A process that is killed before each of its steps in the file system, one after the other.

`python -m support.killed` is not needed: a test runs `kill_at_every_step` in a separate process, as it forks.
"""

import os
import signal
import sys
from collections.abc import Callable

STEPS = ("open", "os.rename", "os.remove", "os.link", "os.chmod", "os.mkdir", "os.rmdir", "tempfile.mkstemp")
"""What Python tells of the file system before it is done (its audit events)."""


def kill_at_every_step(prepare: Callable[[], None], write: Callable[[], None], check: Callable[[int], None]) -> int:
    """Run `write` in forks that are killed before their first, second, … step, until one finishes.

    Args:
        prepare: Makes things as they were, before each.
        write: What is killed.
        check: Looks at what was left, with the number of steps that were done.

    Returns:
        How many steps there are.
    """
    steps = 0
    while True:
        prepare()
        child = os.fork()
        if child == 0:
            _die_at(steps)
            write()
            os._exit(0)
        _, status = os.waitpid(child, 0)
        check(steps)
        if not os.WIFSIGNALED(status):
            if status != 0:
                raise SystemExit(f"the process to be killed failed first: {status}")
            return steps
        steps += 1


def _die_at(step: int) -> None:
    done = 0

    def count(event: str, arguments: tuple[object, ...]) -> None:
        nonlocal done
        if event in STEPS and not _is_module(arguments):
            if done == step:
                os.kill(os.getpid(), signal.SIGKILL)
            done += 1

    sys.addaudithook(count)


def _is_module(arguments: tuple[object, ...]) -> bool:
    """Whether it is a file that an import opens."""
    return bool(arguments) and isinstance(arguments[0], str) and arguments[0].endswith((".py", ".pyc", ".so"))

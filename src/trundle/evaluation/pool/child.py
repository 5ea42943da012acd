"""What the processes of a pool begin with: a warm server that only imports and then forks workers, or a single worker.

`guard/start.py` calls these functions, with the start message.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import importlib
import json
import os
import selectors
import signal
import socket
import sys
import time
import traceback
from typing import Any, NoReturn

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36
_MESSAGE_BYTES = 1 << 16
_SWEEP_S = 0.5


def serve(start: dict[str, Any]) -> None:
    """Run the server: import, then fork workers until the pool is gone.

    Args:
        start: What `launch.describe_start` gives, and `descriptors`: the socket to the pool.
    """
    (control,) = start["descriptors"]
    _Server(socket.socket(fileno=control), start).serve()


def work(start: dict[str, Any]) -> NoReturn:
    """Run a worker that was not forked from a server.

    Args:
        start: What `launch.describe_start` gives, and `descriptors`: a worker's ends of its socket and pipes.
    """
    sock, output, dump = start["descriptors"]
    _end_with_input(os.dup(0))
    _work(socket.socket(fileno=sock), output, dump, start)


class _Server:
    """Imports, and then forks a worker for each request."""

    def __init__(self, control: socket.socket, start: dict[str, Any]) -> None:
        self._control = control
        self._start = start
        self._workers: dict[int, int] = {}
        """The process numbers, by the pool's numbers of the workers."""

    def serve(self) -> None:
        """Fork workers until the pool is gone."""
        # Ctrl-C and the like are for the pool, whose end this one sees.
        for name in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(name, signal.SIG_IGN)
        if sys.platform == "linux":
            _control_process(_PR_SET_CHILD_SUBREAPER, 1)
        self._say(**_preload(self._start["preload"]))
        gc.collect()
        gc.freeze()  # so that no worker copies pages by collecting what it never frees
        wake_read, wake_write = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        signal.set_wakeup_fd(wake_write)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        with selectors.DefaultSelector() as selector:
            selector.register(self._control, selectors.EVENT_READ)
            selector.register(wake_read, selectors.EVENT_READ)
            _watch_parent(selector, self._start["parent"])
            while True:
                ready = {key.fileobj for key, _ in selector.select()}
                if wake_read in ready:
                    os.read(wake_read, 1 << 16)
                    self._reap()
                if ready - {wake_read, self._control} or (
                    self._control in ready and not self._answer((wake_read, wake_write), selector)
                ):
                    self._end()

    def _answer(self, wake: tuple[int, int], selector: selectors.BaseSelector) -> bool:
        """Do what the pool asks; return False if the pool is gone."""
        content, given, _, _ = socket.recv_fds(self._control, _MESSAGE_BYTES, 3)
        if not content:
            return False
        request = json.loads(content)
        number = request["worker"]
        if request["do"] == "start":
            try:
                pid = os.fork()
            except OSError as error:
                self._say(failed=f"{error.strerror or error}; give the pool fewer workers")
                return True
            if pid == 0:
                signal.set_wakeup_fd(-1)
                for descriptor in wake:
                    os.close(descriptor)
                selector.close()
                self._be_worker(given)
            for descriptor in given:
                os.close(descriptor)
            self._workers[number] = pid
        elif number in self._workers:
            _signal_group(self._workers[number], request["signal"])
        return True

    def _be_worker(self, given: list[int]) -> NoReturn:
        try:
            os.setsid()
            server = os.getppid()
            _control_process(_PR_SET_PDEATHSIG, signal.SIGKILL)
            _control_process(_PR_SET_CHILD_SUBREAPER, 0)
            if os.getppid() != server:
                os._exit(1)
            # If the system runs out of memory, a worker is the one to go.
            with contextlib.suppress(OSError), open("/proc/self/oom_score_adj", "w", encoding="ascii") as file:  # noqa: PTH123
                file.write("500")
            for name in (signal.SIGTERM, signal.SIGHUP, signal.SIGCHLD):
                signal.signal(name, signal.SIG_DFL)
            self._control.close()
            _work(socket.socket(fileno=given[0]), given[1], given[2], self._start)
        except BaseException:  # noqa: BLE001 - never back into the server's loop
            traceback.print_exc()
        finally:
            os._exit(1)

    def _reap(self) -> None:
        """Tell the pool which workers have ended; kill what they left in their process groups."""
        while True:
            try:
                # Not reaped yet, so that its number is nobody else's while its group is killed.
                ended = os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
            except ChildProcessError:
                return
            if ended is None:
                return
            with contextlib.suppress(OSError):
                os.killpg(ended.si_pid, signal.SIGKILL)
            _, status = os.waitpid(ended.si_pid, 0)
            number = next((number for number, pid in self._workers.items() if pid == ended.si_pid), None)
            if number is not None:
                del self._workers[number]
                self._say(ended=number, status=os.waitstatus_to_exitcode(status))

    def _say(self, **message: object) -> None:
        with contextlib.suppress(OSError):
            self._control.send(json.dumps(message).encode())

    def _end(self) -> NoReturn:
        """Kill all workers and what they started."""
        for pid in self._workers.values():
            _signal_group(pid, signal.SIGKILL)
        until = time.monotonic() + _SWEEP_S
        while time.monotonic() < until:
            for pid in _children():
                with contextlib.suppress(OSError):
                    os.kill(pid, signal.SIGKILL)
            try:
                if os.waitpid(-1, os.WNOHANG)[0] == 0:
                    time.sleep(0.005)
            except ChildProcessError:
                break
        os._exit(0)


def _preload(names: list[str]) -> dict[str, Any]:
    """Import modules; say how many threads there are then, or what failed."""
    for name in names:
        try:
            importlib.import_module(name)
        except BaseException as error:  # noqa: BLE001 - whatever it is, the pool is told
            return {"failed": f"{name} cannot be imported: {type(error).__name__}: {error}"[:4000]}
    importlib.import_module("trundle.evaluation.pool.worker")
    return {"threads": len(os.listdir("/proc/self/task"))}  # noqa: PTH208 - pathlib may not be imported


def _work(sock: socket.socket, output: int, dump: int, start: dict[str, Any]) -> NoReturn:
    from trundle.evaluation.pool.worker import WorkerStart, run_worker

    run_worker(sock, output, dump, WorkerStart(start["task"], start["memory_bytes"], start["ends_itself_s"]))


def _control_process(option: int, value: int) -> None:
    ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


def _watch_parent(selector: selectors.BaseSelector, parent: int) -> None:
    """Wake up when the pool's process ends, even if another process holds the other end of the socket."""
    with contextlib.suppress(OSError):
        selector.register(os.pidfd_open(parent), selectors.EVENT_READ)
    if os.getppid() != parent:
        os._exit(1)


def _end_with_input(number: int) -> None:
    """End this process and its group when the pool closes its end of standard input."""
    import threading

    def wait() -> None:
        os.read(number, 1)
        os.killpg(0, signal.SIGKILL)

    threading.Thread(target=wait, daemon=True).start()


def _signal_group(pid: int, number: int) -> None:
    """Signal a process, with its group if it is to be killed."""
    with contextlib.suppress(OSError):
        if number == signal.SIGKILL:
            os.killpg(pid, number)
    with contextlib.suppress(OSError):
        os.kill(pid, number)


def _children() -> list[int]:
    try:
        with open("/proc/thread-self/children", encoding="ascii") as file:  # noqa: PTH123 - of the system
            return [int(word) for word in file.read().split()]
    except OSError:
        return []

"""Tasks for the pool: what jobs of plug-ins may do to the process that they run in."""

from __future__ import annotations

import ctypes
import faulthandler
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any


class Echo:
    """Returns its job."""

    def setup(self) -> None:
        pass

    def __call__(self, job, note):
        return job


class Large(Echo):
    """Takes many bytes; returns how many."""

    def __init__(self, size: int) -> None:
        self.content = b"x" * size

    def __call__(self, job, note):
        return len(self.content)


class Ask(Echo):
    """A job is the name of a method here, with arguments."""

    def __init__(self, *, hang: bool = False) -> None:
        self.hang = hang

    def setup(self) -> None:
        if self.hang:
            time.sleep(1000)

    def __call__(self, job, note):
        name, *arguments = job if isinstance(job, tuple) else (job,)
        return getattr(self, f"do_{name}")(note, *arguments)

    def do_return(self, note, value=None):
        return value

    def do_pid(self, note):
        time.sleep(0.05)  # so that each worker has one
        return os.getpid()

    def do_environment(self, note, name):
        return os.environ.get(name)

    def do_signal_of(self, note, number):
        return str(signal.getsignal(number))

    def do_raise(self, note, text="planted"):
        raise RuntimeError(text)

    def do_raise_library(self, note):
        import json

        return json.loads("{")

    def do_raise_unspeakable(self, note):
        class UnspeakableError(Exception):
            def __str__(self):
                raise RuntimeError("planted")

        raise UnspeakableError

    def do_interrupt(self, note):
        raise KeyboardInterrupt

    def do_exit(self, note):
        sys.exit(3)

    def do_exit_hard(self, note, status=0):
        os._exit(status)

    def do_segfault(self, note):
        ctypes.string_at(0)

    def do_abort(self, note):
        os.write(2, b"terminate called: planted\n")
        os.abort()

    def do_segfault_noted(self, note):
        note({"stage": "drive", "seed": 4})
        ctypes.string_at(0)

    def do_sleep(self, note, seconds=1000):
        time.sleep(seconds)

    def do_hold_gil(self, note):
        ctypes.PyDLL(None).sleep(1000)

    def do_announce(self, note, folder, number, with_child):
        """Says which process this is and which child it has, and hangs."""
        pids = f"{os.getpid()} {self.do_leave_child(note) if with_child else ''}"
        part = Path(folder, f"{number}.part")
        part.write_text(pids)
        part.rename(part.with_suffix(".pids"))
        time.sleep(1000)

    def do_stop(self, note):
        os.kill(os.getpid(), signal.SIGSTOP)

    def do_hog(self, note):
        kept = []
        while True:
            kept.append(bytearray(10_000_000))

    def do_grow_slowly(self, note, megabytes):
        """Takes memory until there is so much of it, and then hangs."""
        kept = []
        for _ in range(megabytes // 10):
            kept.append(b"x" * 10_000_000)
            time.sleep(0.1)
        time.sleep(1000)

    def do_hog_like_mujoco(self, note):
        raise ValueError("Could not allocate memory")

    def do_kill_itself(self, note):
        os.kill(os.getpid(), signal.SIGKILL)

    def do_kill_once(self, note, file):
        return self._once(file, lambda: os.kill(os.getpid(), signal.SIGKILL))

    def do_hang_once(self, note, file):
        return self._once(file, lambda: time.sleep(1000))

    def do_kill_server_once(self, note, file):
        return self._once(file, lambda: (os.kill(os.getppid(), signal.SIGKILL), time.sleep(1000)))

    def _once(self, file, act):
        if not Path(file).exists():
            Path(file).touch()
            act()
        return "second"

    def do_return_unpicklable(self, note):
        return threading.Lock()

    def do_return_bytes(self, note, size):
        return bytes(size)

    def do_close_standard(self, note):
        for number in range(3):
            os.close(number)

    def do_close_all(self, note):
        os.closerange(0, 256)
        time.sleep(1000)

    def do_ignore_signals(self, note):
        for number in set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP}:
            signal.signal(number, signal.SIG_IGN)
        faulthandler.disable()
        time.sleep(1000)

    def do_print(self, note, text):
        sys.stdout.write(text + "\n")
        os.write(1, f"raw {text}\n".encode())
        os.write(2, f"error {text}\n".encode())

    def do_print_and_crash(self, note, text):
        sys.stdout.write(text + "\n")
        ctypes.string_at(0)

    def do_flood(self, note, size):
        os.write(1, b"x" * 65536)
        for _ in range(size // 65536):
            os.write(1, b"x" * 65536)

    def do_leave_child(self, note, new_session=False):
        child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"], start_new_session=new_session)
        return child.pid

    def do_leave_threads(self, note, count):
        for _ in range(count):
            threading.Thread(target=time.sleep, args=(1000,), daemon=True).start()
        return os.getpid()

    def do_fork_through(self, note):
        """A child that comes back from the job."""
        child = os.fork()
        if child:
            os.waitpid(child, 0)
        return "parent" if child else "child"

    def do_leave_fork_with_socket(self, note):
        """A child that keeps the worker's socket open after the worker has crashed."""
        if os.fork() == 0:
            time.sleep(1000)
        ctypes.string_at(0)

    def do_note_often(self, note):
        for k in range(1000):
            note({"k": k})
        ctypes.string_at(0)


class FailingSetup(Echo):
    """Its set-up raises."""

    def setup(self) -> None:
        raise OSError("no such map: planted.yaml")


class CrashingSetup(Echo):
    """Its set-up crashes."""

    def setup(self) -> None:
        ctypes.string_at(0)


class FailingSetupOnce(Echo):
    """Its set-up raises the first time."""

    def __init__(self, file: Path) -> None:
        self.file = file

    def setup(self) -> None:
        if not self.file.exists():
            self.file.touch()
            raise OSError("planted")


class Planted(Echo):
    """Jobs of a batch with four that fail; counts in a file of its own for each try."""

    def __init__(self, planted: dict[int, Any]) -> None:
        self.planted = planted
        self.ask = Ask()

    def __call__(self, job, note):
        note({"job": job})
        if job in self.planted:
            return self.ask(self.planted[job], note)
        return job * job

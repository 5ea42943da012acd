import os
import pty
import re
import select
import signal
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest


class Terminal:
    """`trundle drive --teleop` in a pseudo-terminal."""

    def __init__(self, folder: Path) -> None:
        self.master, self.slave = pty.openpty()
        self.before = termios.tcgetattr(self.slave)
        self.process = subprocess.Popen(
            [sys.executable, "-m", "trundle", "drive", "nova_carter", "--teleop", "--backend=kinematic", "--out=."],
            stdin=self.slave,
            stdout=subprocess.PIPE,
            stderr=self.slave,
            cwd=folder,
        )
        self.text = ""

    def wait_for(self, pattern: str) -> re.Match[str]:
        deadline = time.monotonic() + 20.0
        while time.monotonic() < deadline and self.process.poll() is None:
            found = re.search(pattern, self.text)
            if found:
                return found
            if select.select([self.master], [], [], 0.1)[0]:
                self.text += os.read(self.master, 65536).decode()
        raise AssertionError(f"{pattern!r} never came; the terminal showed {self.text[-500:]!r}")

    def send(self, keys: bytes) -> None:
        self.text = ""
        os.write(self.master, keys)

    def close(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()
        os.close(self.master)
        os.close(self.slave)


@pytest.fixture
def terminal(tmp_path: Path):
    terminal = Terminal(tmp_path)
    yield terminal
    terminal.close()


def last_row(folder: Path) -> dict[str, str]:
    header, *rows = (folder / "drive.csv").read_text().splitlines()
    return dict(zip(header.split(","), rows[-1].split(","), strict=True))


def test_keys_drive_and_the_terminal_comes_back(terminal: Terminal, tmp_path: Path) -> None:
    terminal.wait_for(r"v  0\.000")
    for _ in range(4):
        terminal.send(b"i")
        terminal.wait_for(r"v  0\.1")
    terminal.wait_for(r"v  0\.000")  # The dead-man let go.
    terminal.send(b"w")
    terminal.wait_for(r"v  0\.[1-9]")
    assert max(len(line) for line in re.split(r"[\r\n]", terminal.text.replace("\x1b[K", ""))) < 60
    terminal.send(b"\x1b[D")
    terminal.wait_for(r"w  0\.[1-9]")
    terminal.send(b"q")
    assert terminal.process.wait(10) == 0
    assert termios.tcgetattr(terminal.slave) == terminal.before
    row = last_row(tmp_path)
    assert float(row["x"]) > 0.05
    assert float(row["yaw"]) > 0.0


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 0), (signal.SIGTERM, 143)])
def test_signals_end_it_with_the_record_and_the_terminal_as_it_was(
    terminal: Terminal, tmp_path: Path, number: signal.Signals, code: int
) -> None:
    terminal.wait_for(r"v  0\.000")
    terminal.process.send_signal(number)
    assert terminal.process.wait(10) == code
    assert termios.tcgetattr(terminal.slave) == terminal.before
    assert float(last_row(tmp_path)["time_s"]) > 0.0

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

from trundle.cli.teleop import DEAD_MAN_S, KeyDrive, split_keys
from trundle.geometry import Twist2D
from trundle.robots import Robot


@pytest.mark.parametrize(
    ("data", "keys", "rest"),
    [
        (b"ijkl", ["i", "j", "k", "l"], b""),
        (b"I \x1b[A\x1b[B\x1bOC\x1b[D", ["i", " ", "i", "k", "l", "j"], b""),
        (b"\x1b[1;5Aq", ["i", "q"], b""),
        (b"\x1b[3~q", ["q"], b""),
        (b"i\x1b", ["i"], b"\x1b"),
        (b"i\x1b[", ["i"], b"\x1b["),
        (b"\x1bi", ["i"], b""),
        (b"\xff", ["\ufffd"], b""),
    ],
)
def test_keys_and_arrows(data: bytes, keys: list[str], rest: bytes) -> None:
    assert split_keys(data) == (keys, rest)


def test_a_key_counts_until_the_dead_man_lets_go() -> None:
    limits = Robot.load("nova_carter").limits
    drive = KeyDrive(limits)
    assert drive.twist(0.0) == Twist2D()
    drive.press("i", 1.0)
    assert drive.twist(0.99 + DEAD_MAN_S).v == pytest.approx(0.6 * limits.linear_speed)
    assert drive.twist(1.0 + DEAD_MAN_S + 0.01) == Twist2D()


def test_two_keys_drive_an_arc_and_space_stops_both() -> None:
    drive = KeyDrive(Robot.load("nova_carter").limits)
    drive.press("k", 0.0)
    drive.press("l", 0.1)
    assert drive.twist(0.15).v < 0 and drive.twist(0.15).w < 0  # noqa: PT018
    drive.press(" ", 0.2)
    assert drive.twist(0.2) == Twist2D()


def test_other_keys_do_nothing() -> None:
    drive = KeyDrive(Robot.load("nova_carter").limits)
    drive.press("x", 0.0)
    assert (drive.twist(0.0), drive.done) == (Twist2D(), False)


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

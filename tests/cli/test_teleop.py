import codecs
import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest

COLUMNS, ROWS = 60, 24
PATIENCE_S = 60.0
"""Until a test gives up waiting: far longer than it takes, on any machine."""


class Terminal:
    """`trundle drive --teleop` in a pseudo-terminal of 60 columns and 24 rows."""

    def __init__(self, folder: Path, *arguments: str, in_place: bool = True) -> None:
        self.master, self.slave = pty.openpty()
        fcntl.ioctl(self.slave, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
        self.before = termios.tcgetattr(self.slave)
        self.process = subprocess.Popen(
            [
                sys.executable,
                "-m",
                "trundle",
                "drive",
                "nova_carter",
                "--teleop",
                "--backend=kinematic",
                "--out=.",
                *list(arguments),
            ],
            stdin=self.slave,
            stdout=subprocess.PIPE,
            stderr=self.slave if in_place else subprocess.PIPE,
            cwd=folder,
        )
        self.text = ""
        self._decode = codecs.getincrementaldecoder("utf-8")().decode

    def wait_for(self, pattern: str, held: bytes = b"") -> re.Match[str]:
        """Wait until the terminal shows this, while a key is held, which repeats."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline and self.process.poll() is None:
            found = re.search(pattern, self.text)
            if found:
                return found
            if held:
                os.write(self.master, held)
            if select.select([self.master], [], [], 0.1)[0]:
                self.text += self._decode(os.read(self.master, 65536))
        raise AssertionError(f"{pattern!r} never came; the terminal showed {self.text[-500:]!r}")

    def hold(self, key: bytes, pattern: str) -> None:
        """Hold a key until the terminal shows this."""
        self.text = ""
        self.wait_for(pattern, key)

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


def lines_of(text: str) -> list[str]:
    return re.split(r"[\r\n]+", re.sub(r"\x1b\[\d*[A-Z]", "", text))


def last_row(folder: Path) -> dict[str, str]:
    header, *rows = (folder / "drive.csv").read_text().splitlines()
    return dict(zip(header.split(","), rows[-1].split(","), strict=True))


def test_keys_drive_and_the_terminal_comes_back(terminal: Terminal, tmp_path: Path) -> None:
    terminal.wait_for(r"v  0\.000")
    terminal.hold(b"i", r"v  0\.4")
    terminal.wait_for(r"v  0\.4(?s:.*)v  0\.000")  # The dead-man let go.
    terminal.hold(b"w", r"v  0\.[3-9]")
    assert max(map(len, lines_of(terminal.text))) < COLUMNS
    terminal.hold(b"\x1b[D", r"w  0\.[1-9]")
    terminal.send(b"q")
    assert terminal.process.wait(PATIENCE_S) == 0
    assert termios.tcgetattr(terminal.slave) == terminal.before
    row = last_row(tmp_path)
    assert float(row["x"]) > 0.05
    assert float(row["yaw"]) > 0.0


def test_a_map_is_redrawn_in_place_and_the_summary_describes_the_drive(tmp_path: Path) -> None:
    terminal = Terminal(tmp_path, "--world=warehouse", "--start=-13,0,1.5708")
    try:
        assert "\n" in terminal.wait_for(r"(?s)obstacle.*\x1b\[15A\r.*\x1b\[15A\r")[0]
        frame = lines_of(terminal.text.split("\x1b[15A\r")[1])[:16]
        assert frame[0].split()[1] == "s"
        assert sum(line.count("^") for line in frame[1:]) == 1
        assert sum(line.count("#") for line in frame[1:]) > 20
        terminal.hold(b"w", r"v  0\.[2-9]")
        terminal.send(b"q")
        out, _ = terminal.process.communicate(timeout=PATIENCE_S)
    finally:
        terminal.close()
    facts = dict(line.split("  ", 1) for line in out.decode().splitlines())
    assert list(facts) == ["driven", "top speed", "turned", "contacts", "final pose", "record"]
    assert float(facts["driven"].split()[0]) > 0.0
    assert facts["contacts"].split() == ["none"]
    assert facts["final pose"].split()[:2] == ["x", "-13.00"]


def test_no_line_of_the_map_is_wider_than_the_terminal(tmp_path: Path) -> None:
    terminal = Terminal(tmp_path, "--world=warehouse")
    try:
        terminal.wait_for(r"(?s)\x1b\[15A\r.*\x1b\[15A\r")
    finally:
        terminal.close()
    lines = lines_of(terminal.text)
    assert 50 < max(map(len, lines)) < COLUMNS


def test_what_is_no_terminal_gets_plain_lines(tmp_path: Path) -> None:
    terminal = Terminal(tmp_path, in_place=False)
    assert terminal.process.stderr is not None
    try:
        lines = [terminal.process.stderr.readline().decode() for _ in range(5)]
        terminal.send(b"q")
        rest = terminal.process.communicate(timeout=PATIENCE_S)[1].decode()
    finally:
        terminal.close()
    assert re.match(r" +0\.1 s x", lines[-1])
    assert "\x1b" not in "".join([*lines, rest])
    assert "Map:" not in "".join(lines)


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 0), (signal.SIGTERM, 143)])
def test_signals_end_it_with_the_record_and_the_terminal_as_it_was(
    terminal: Terminal, tmp_path: Path, number: signal.Signals, code: int
) -> None:
    terminal.wait_for(r"v  0\.000")
    terminal.process.send_signal(number)
    assert terminal.process.wait(PATIENCE_S) == code
    assert termios.tcgetattr(terminal.slave) == terminal.before
    assert float(last_row(tmp_path)["time_s"]) > 0.0

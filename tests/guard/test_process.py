"""What every child process begins with, and what its end means."""

import signal
import subprocess
import sys

import pytest

from trundle.guard import start
from trundle.guard.process import last_line, signal_name


@pytest.mark.parametrize(
    ("sent", "said"),
    [
        (b"", "0 of the 8 bytes of its length arrived"),
        ((9).to_bytes(8, "big") + b"123", "3 of its 9 bytes arrived"),
        ((3).to_bytes(8, "big") + b"123", "it cannot be unpickled: UnpicklingError"),
    ],
)
def test_a_start_message_that_cannot_be_read_is_named(sent, said):
    done = subprocess.run(
        [sys.executable, start.__file__, "trundle.guard.child:main"], input=sent, capture_output=True, check=False
    )
    assert done.returncode == 1
    assert f"the start message cannot be read: {said}" in done.stderr.decode()
    assert len(done.stderr.splitlines()) == 1


def test_a_signal_is_named_where_it_has_a_name():
    assert signal_name(signal.SIGSEGV) == "SIGSEGV"
    assert signal_name(77) == "signal 77"


@pytest.mark.parametrize(("output", "line"), [("", ""), (" \n\n", ""), ("first\n  last \n\n", "last")])
def test_the_last_line_is_the_last_that_is_not_blank(output, line):
    assert last_line(output) == line

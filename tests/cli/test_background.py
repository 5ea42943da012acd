"""A command that a shell started in the background, where it ignores SIGINT."""

from __future__ import annotations

import signal

import pytest

from trundle.cli.shared.termination import ends_as_by_ctrl_c


@pytest.fixture
def ignored():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it_as_ctrl_c(ignored, number):
    with pytest.raises(KeyboardInterrupt), ends_as_by_ctrl_c():
        signal.raise_signal(number)
    assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN

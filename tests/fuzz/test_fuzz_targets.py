"""Every target for some rounds; that each of them can fail is tested beside this."""

from __future__ import annotations

import pytest

from fuzz.loop import play
from fuzz.targets import TARGETS
from support.kernel_calls import KERNELS


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_no_round_has_a_finding(name):
    target = TARGETS[name]
    assert play(target.one_round, seed=1, count=target.quick) == target.quick


def test_every_kernel_has_a_target():
    assert {kernel for target in TARGETS.values() for kernel in target.kernels} == set(KERNELS)

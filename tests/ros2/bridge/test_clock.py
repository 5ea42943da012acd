"""The time on the network over restarts."""

from trundle.ros2.role import JUMP_S, SimulationClock


def test_the_first_run_begins_at_zero() -> None:
    clock = SimulationClock()
    clock.begin()
    assert clock.now == 0.0
    assert clock.set(0.5) == 0.5


def test_after_a_restart_the_time_goes_on_at_the_next_full_second() -> None:
    clock = SimulationClock()
    clock.begin()
    clock.set(3.2)
    clock.begin()
    assert clock.now == 4.0
    assert clock.set(0.25) == 4.25
    clock.set(0.9999)
    clock.begin()
    assert clock.now == 5.0
    assert JUMP_S == 1.0


def test_a_reset_of_the_time_begins_at_zero_once() -> None:
    clock = SimulationClock()
    clock.begin()
    clock.set(3.2)
    clock.start_over()
    clock.begin()
    assert clock.now == 0.0
    clock.set(1.5)
    clock.begin()
    assert clock.now == 2.0

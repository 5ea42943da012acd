from trundle.serve.wheel import ANSWER_S, Wheel


def _of_two() -> Wheel:
    wheel = Wheel()
    wheel.join(1)
    wheel.join(2)
    return wheel


def test_the_first_client_drives() -> None:
    wheel = _of_two()
    assert (wheel.driver, wheel.request, len(wheel)) == (1, None, 2)


def test_a_takeover_is_asked_for_and_granted() -> None:
    wheel = _of_two()
    assert wheel.ask(2, 0.0)
    assert (wheel.driver, wheel.request) == (1, 2)
    assert wheel.answer(1, "grant")
    assert (wheel.driver, wheel.request) == (2, None)


def test_a_takeover_may_be_refused() -> None:
    wheel = _of_two()
    wheel.ask(2, 0.0)
    assert wheel.answer(1, "refuse")
    assert (wheel.driver, wheel.request) == (1, None)


def test_only_the_driver_answers_and_only_a_request() -> None:
    wheel = _of_two()
    wheel.join(3)
    assert not wheel.answer(1, "grant")
    wheel.ask(2, 0.0)
    assert not wheel.answer(3, "grant")
    assert not wheel.answer(2, "grant")
    assert not wheel.ask(3, 0.0)
    assert not wheel.ask(1, 0.0)
    assert (wheel.driver, wheel.request) == (1, 2)


def test_who_asked_drives_once_the_driver_has_left() -> None:
    wheel = _of_two()
    wheel.ask(2, 0.0)
    assert wheel.leave(1)
    assert (wheel.driver, wheel.request) == (2, None)


def test_without_a_driver_the_next_that_asks_drives() -> None:
    wheel = _of_two()
    wheel.leave(1)
    assert wheel.driver is None
    wheel.join(3)
    assert wheel.driver is None
    assert wheel.ask(2, 0.0)
    assert wheel.driver == 2


def test_a_request_goes_with_its_client() -> None:
    wheel = _of_two()
    wheel.ask(2, 0.0)
    assert not wheel.leave(2)
    assert (wheel.driver, wheel.request) == (1, None)


def test_a_request_that_nobody_answers_is_granted() -> None:
    wheel = _of_two()
    wheel.ask(2, 10.0)
    assert not wheel.expire(10.0 + ANSWER_S - 0.1)
    assert wheel.expire(10.0 + ANSWER_S)
    assert (wheel.driver, wheel.request) == (2, None)
    assert not wheel.expire(1e9)

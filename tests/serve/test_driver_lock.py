from trundle.serve.hub import ANSWER_S, DriverLock


def _of_two() -> DriverLock:
    lock = DriverLock()
    lock.join(1)
    lock.join(2)
    return lock


def test_the_first_client_drives() -> None:
    lock = _of_two()
    assert (lock.driver, lock.request, len(lock)) == (1, None, 2)


def test_a_takeover_is_asked_for_and_granted() -> None:
    lock = _of_two()
    assert lock.ask(2, 0.0)
    assert (lock.driver, lock.request) == (1, 2)
    assert lock.answer(1, "grant")
    assert (lock.driver, lock.request) == (2, None)


def test_a_takeover_may_be_refused() -> None:
    lock = _of_two()
    lock.ask(2, 0.0)
    assert lock.answer(1, "refuse")
    assert (lock.driver, lock.request) == (1, None)


def test_only_the_driver_answers_and_only_a_request() -> None:
    lock = _of_two()
    lock.join(3)
    assert not lock.answer(1, "grant")
    lock.ask(2, 0.0)
    assert not lock.answer(3, "grant")
    assert not lock.answer(2, "grant")
    assert not lock.ask(3, 0.0)
    assert not lock.ask(1, 0.0)
    assert (lock.driver, lock.request) == (1, 2)


def test_who_asked_drives_once_the_driver_has_left() -> None:
    lock = _of_two()
    lock.ask(2, 0.0)
    assert lock.leave(1)
    assert (lock.driver, lock.request) == (2, None)


def test_without_a_driver_the_next_that_asks_drives() -> None:
    lock = _of_two()
    lock.leave(1)
    assert lock.driver is None
    lock.join(3)
    assert lock.driver is None
    assert lock.ask(2, 0.0)
    assert lock.driver == 2


def test_a_request_goes_with_its_client() -> None:
    lock = _of_two()
    lock.ask(2, 0.0)
    assert not lock.leave(2)
    assert (lock.driver, lock.request) == (1, None)


def test_a_request_that_nobody_answers_is_granted() -> None:
    lock = _of_two()
    lock.ask(2, 10.0)
    assert not lock.expire(10.0 + ANSWER_S - 0.1)
    assert lock.expire(10.0 + ANSWER_S)
    assert (lock.driver, lock.request) == (2, None)
    assert not lock.expire(1e9)

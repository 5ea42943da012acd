import json

from trundle.serve.run_feed import RunLog


def _read_all(log: RunLog) -> list[dict]:
    cursor, messages = 0, []
    while (found := log.read(cursor)) is not None:
        text, cursor = found
        messages.append(json.loads(text))
    return messages


def test_an_empty_log_has_nothing_to_read() -> None:
    log = RunLog()
    log.add([], [], [])
    assert log.read(0) is None


def test_what_was_added_is_read_in_order_and_once() -> None:
    log = RunLog()
    log.add([[0.0, 1], [0.1, 2]], [{"t": 0}], [])
    first, cursor = log.read(0) or ("", 0)
    log.add([[0.2, 3]], [], [{"kind": "goal"}])
    assert json.loads(first)["rows"] == [[0.0, 1], [0.1, 2]]
    second, cursor = log.read(cursor) or ("", 0)
    assert json.loads(second) == {
        "type": "log",
        "from": 2,
        "rows": [[0.2, 3]],
        "paths": [],
        "events": [{"kind": "goal"}],
    }
    assert log.read(cursor) is None


def test_what_comes_before_the_first_row_is_not_dropped_by_what_follows() -> None:
    log = RunLog()
    log.add([], [], [{"kind": "start"}])
    first, cursor = log.read(0) or ("", 0)
    log.add([[0.0, 1]], [], [{"kind": "plan"}])
    second, _ = log.read(cursor) or ("", 0)
    assert json.loads(first)["from"] == 0
    assert "from" not in json.loads(second)
    assert json.loads((log.read(0) or ("", 0))[0])["events"] == [{"kind": "start"}, {"kind": "plan"}]


def test_a_client_that_comes_late_gets_everything_in_few_messages_of_limited_size() -> None:
    log = RunLog()
    rows = [[index / 20, index * 0.123456] for index in range(40_000)]
    for row in rows:
        log.add([row], [], [])
    messages = _read_all(log)
    assert [row for message in messages for row in message["rows"]] == rows
    assert 2 <= len(messages) <= 10
    for message in messages:
        assert message["rows"][0] == rows[message["from"]]


def test_numbers_that_json_has_not_become_null() -> None:
    log = RunLog()
    log.add([[float("nan"), float("inf"), 1.0]], [], [])
    assert _read_all(log)[0]["rows"] == [[None, None, 1.0]]

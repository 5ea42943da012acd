import json

from trundle.serve.hub import BURST, RATE_PER_S, Client, fragments, is_long
from trundle.serve.run_feed import RunFeed


def _feed(number: int = 1) -> RunFeed:
    feed = RunFeed(number, json.dumps({"type": "scene", "of": number}))
    feed.run = json.dumps({"type": "run", "n": number})
    return feed


def _take_all(client: Client, feed: RunFeed | None) -> list[str]:
    kinds = []
    while (text := client.take(feed)) is not None:
        kinds.append(json.loads(text)["type"])
    return kinds


def test_a_new_client_gets_scene_run_and_the_whole_log() -> None:
    feed = _feed()
    feed.log.add([[0]], [], [])
    feed.log.add([[1]], [], [])
    feed.frame = feed.frame.next('{"type":"frame"}')
    assert sorted(_take_all(Client(1), feed)) == ["frame", "log", "run", "scene"]


def test_a_client_gets_nothing_twice() -> None:
    feed, client = _feed(), Client(1)
    feed.log.add([[0]], [], [])
    feed.frame = feed.frame.next('{"type":"frame"}')
    _take_all(client, feed)
    assert client.take(feed) is None
    feed.log.add([[1]], [], [])
    assert _take_all(client, feed) == ["log"]


def test_of_frames_a_slow_client_gets_the_newest_and_of_the_log_everything() -> None:
    feed, client = _feed(), Client(1)
    _take_all(client, feed)
    rows = []
    for index in range(50):
        feed.log.add([[index]], [], [])
        feed.frame = feed.frame.next(json.dumps({"type": "frame", "t": index}))
    frames = []
    while (text := client.take(feed)) is not None:
        message = json.loads(text)
        rows += message.get("rows", [])
        frames += [message["t"]] if message["type"] == "frame" else []
    assert rows == [[index] for index in range(50)]
    assert frames == [49]


def test_neither_log_nor_frames_keep_the_other_from_a_slow_client() -> None:
    feed, client = _feed(), Client(1)
    _take_all(client, feed)
    kinds = []
    for index in range(10):
        feed.log.add([[index]], [], [])
        feed.frame = feed.frame.next('{"type":"frame"}')
        kinds.append(json.loads(client.take(feed) or "")["type"])
    assert kinds.count("log") == kinds.count("frame") == 5


def test_another_run_begins_with_its_scene() -> None:
    client = Client(1)
    _take_all(client, _feed(1))
    assert _take_all(client, _feed(2)) == ["scene", "run"]
    assert _take_all(client, None) == []


def test_the_end_comes_last() -> None:
    feed, client = _feed(), Client(1)
    feed.end = '{"type":"end"}'
    feed.solids.append('{"type":"solid"}')
    feed.log.add([[1]], [], [])
    assert _take_all(client, feed)[-1] == "end"


def test_replies_come_first_and_are_bounded() -> None:
    client = Client(1)
    for index in range(1000):
        client.reply(json.dumps({"type": "error", "text": str(index)}))
    kinds = _take_all(client, _feed())
    assert kinds[:-2] == ["error"] * (len(kinds) - 2)
    assert len(kinds) < 100


def test_messages_are_counted_by_time() -> None:
    client = Client(1)
    assert all(client.may_send(1.0) for _ in range(int(BURST)))
    assert not client.may_send(1.0)
    assert all(client.may_send(10.0) for _ in range(int(BURST)))
    assert not client.may_send(10.0)
    steady = Client(2)
    assert all(steady.may_send(index / (0.99 * RATE_PER_S)) for index in range(1000))


def test_long_messages_are_sent_in_parts() -> None:
    text = "x" * 200_000
    assert is_long(text)
    assert not is_long("x")
    assert "".join(fragments(text)) == text
    assert len(list(fragments(text))) > 2

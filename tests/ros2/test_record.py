import errno
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import yaml
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from trundle.bags import read_info, recover
from trundle.bags.bag_writer import BagWriter
from trundle.errors import InputError, OutputError
from trundle.messages.codec import DISTROS, OLD_BAGS, Codec
from trundle.messages.qos import CLOCK, LATCHED, Qos
from trundle.ros2.record import WireRecord

TEXT = "std_msgs/msg/String"


@pytest.fixture
def codec() -> Codec:
    return Codec("jazzy")


def text(codec: Codec, words: str) -> bytes:
    return codec.encode(codec.make(TEXT, data=words))


def read(path: Path) -> list[tuple[str, int, str]]:
    with AnyReader([path]) as reader:
        return [
            (connection.topic, time, reader.deserialize(data, connection.msgtype).data)
            for connection, time, data in reader.messages()
        ]


def test_what_was_written_and_received_is_read_back(codec: Codec, tmp_path: Path) -> None:
    with WireRecord(tmp_path / "wire.mcap", "jazzy", codec) as record:
        record.add("/latched", TEXT, LATCHED, text(codec, "first"), 0.0)
        record.add("/late", TEXT, Qos(), text(codec, "second"), 1.25)
        record.add("/latched", TEXT, LATCHED, text(codec, "third"), 2.5)
        assert not record.path.exists()
    assert record.messages == 3
    assert read(record.path) == [
        ("/latched", 0, "first"),
        ("/late", 1_250_000_000, "second"),
        ("/latched", 2_500_000_000, "third"),
    ]


@pytest.mark.parametrize("distro", DISTROS)
def test_qos_and_hashes_are_those_of_the_distribution(distro, tmp_path: Path) -> None:
    codec = Codec(distro)
    with WireRecord(tmp_path / "wire.mcap", distro, codec) as record:
        record.add("/text", TEXT, LATCHED, text(codec, "words"), 0.0)
        record.add("/clock_text", TEXT, CLOCK, text(codec, "words"), 0.0)
    with record.path.open("rb") as stream:
        found = {one.topic: one.metadata for one in make_reader(stream).get_summary().channels.values()}
    assert {one["topic_type_hash"] for one in found.values()} == {codec.type_hash(TEXT)}
    for name, qos in (("/text", LATCHED), ("/clock_text", CLOCK)):
        profile = qos.profile(numbers=distro in OLD_BAGS)
        assert yaml.safe_load(found[name]["offered_qos_profiles"]) == [profile]


def test_two_types_on_one_topic_are_both_recorded(codec: Codec, tmp_path: Path) -> None:
    other = "std_msgs/msg/Bool"
    with WireRecord(tmp_path / "wire.mcap", "jazzy", codec) as record:
        record.add("/cmd", TEXT, Qos(), text(codec, "go"), 0.0)
        record.add("/cmd", other, Qos(), codec.encode(codec.make(other, data=True)), 0.1)
    assert {(one.name, one.type_name, one.count) for one in read_info(record.path).topics} == {
        ("/cmd", TEXT, 1),
        ("/cmd", other, 1),
    }


def test_after_a_reset_the_recording_goes_on_after_what_it_has(codec: Codec, tmp_path: Path) -> None:
    with WireRecord(tmp_path / "wire.mcap", "jazzy", codec) as record:
        for time in (0.0, 10.0, 9.95, 0.0, 0.5):
            record.add("/text", TEXT, Qos(), text(codec, f"{time}"), time)
    assert [time / 1e9 for _, time, _ in sorted(read(record.path), key=lambda one: one[1])] == [
        0.0,
        9.95,
        10.0,
        10.0,
        10.5,
    ]


def test_threads_may_record_at_once(codec: Codec, tmp_path: Path) -> None:
    data = text(codec, "words")
    with WireRecord(tmp_path / "wire.mcap", "jazzy", codec) as record:

        def add(name: str) -> None:
            for index in range(500):
                record.add(name, TEXT, Qos(), data, 0.01 * index)

        threads = [threading.Thread(target=add, args=(f"/text{number}",)) for number in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert len(read(record.path)) == 2000


def test_a_killed_process_leaves_all_but_the_last_second(tmp_path: Path) -> None:
    script = Path(__file__).with_name("killed_wire.py")
    path = tmp_path / "wire.mcap"
    with subprocess.Popen([sys.executable, str(script), str(path)], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for _ in range(100):
            last = float(process.stdout.readline())
        process.send_signal(signal.SIGKILL)
    done = recover(tmp_path / "wire.partial.mcap")
    assert done.path == path
    assert done.end_s >= last - 1.2
    with AnyReader([path]) as reader:
        assert {one.topic for one in reader.connections} == {"/map_text", "/text"}


def test_a_full_disk_ends_the_recording_and_nothing_else(
    codec: Codec, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    record = WireRecord(tmp_path / "wire.mcap", "jazzy", codec)
    record.add("/text", TEXT, Qos(), text(codec, "kept"), 0.0)

    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(BagWriter, "write", fail)
        record.add("/text", TEXT, Qos(), text(codec, "lost"), 0.1)
    record.add("/text", TEXT, Qos(), text(codec, "too late"), 0.2)
    record.close()
    assert "No space left on device" in record.error
    assert sum("the recording stopped" in line.getMessage() for line in caplog.records) == 1
    assert not record.path.exists()
    assert recover(tmp_path / "wire.partial.mcap").messages == 1


def test_another_recording_is_not_overwritten_unless_wanted(codec: Codec, tmp_path: Path) -> None:
    path = tmp_path / "wire.mcap"
    WireRecord(path, "jazzy", codec).close()
    with pytest.raises(OutputError, match="already exists"):
        WireRecord(path, "jazzy", codec)
    WireRecord(path, "jazzy", codec, overwrite=True).close()
    with pytest.raises(InputError, match=r"ends in \.mcap"):
        WireRecord(tmp_path / "wire.bag", "jazzy", codec)

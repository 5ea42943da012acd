import pytest
from rosbags.highlevel import AnyReader

from trundle.bags import read_info, recover
from trundle.errors import InputError, OutputError


def count_messages(path) -> int:
    with AnyReader([path]) as reader:
        return sum(1 for one, _, data in reader.messages() if reader.deserialize(data, one.msgtype))


def test_a_file_that_was_never_closed_is_recovered_up_to_its_last_second(recorded, partial):
    done = recover(partial)
    assert done.path == partial.with_name("run.mcap")
    assert done.damage is not None
    assert done.end_s >= recorded.steps[-1].state.time - 1.2
    assert count_messages(done.path) == done.messages
    assert partial.exists()


def test_what_is_cut_at_any_byte_is_recovered_up_to_the_chunk_before(recorded, partial):
    content = partial.read_bytes()
    first = recover(partial).messages
    found = []
    for cut in range(len(content) - 1, len(content) // 3, -len(content) // 24):
        partial.write_bytes(content[:cut])
        done = recover(partial, overwrite=True)
        assert done.damage == "it ends within a record"
        assert count_messages(done.path) == done.messages
        found.append(done.messages)
    assert found == sorted(found, reverse=True)
    assert found[0] <= first


def test_a_recovered_file_knows_its_run(recorded, partial):
    info = read_info(recover(partial).path)
    assert info.damage is None
    assert info.record is not None
    assert info.record.run.name == recorded.info.name
    assert info.record.episode is None


def test_a_complete_file_is_copied_whole(recorded, tmp_path):
    done = recover(recorded.path, tmp_path / "copy.mcap")
    assert done.damage is None
    assert done.messages == count_messages(recorded.path)
    info = read_info(done.path)
    assert info.record is not None
    assert info.record.episode == read_info(recorded.path).record.episode


def test_damage_within_a_chunk_ends_the_recovery_there(recorded, tmp_path):
    content = bytearray(recorded.path.read_bytes())
    content[len(content) // 2 : len(content) // 2 + 8] = bytes(8)
    (tmp_path / "bad.mcap").write_bytes(content)
    done = recover(tmp_path / "bad.mcap")
    assert done.path.name == "bad.recovered.mcap"
    assert done.damage is not None
    assert 0 < done.messages < count_messages(recorded.path)


@pytest.mark.parametrize("length", [2**40, 2**63, 2**64 - 1])
def test_a_record_that_gives_a_huge_length_of_its_data_takes_no_memory(recorded, tmp_path, length):
    content = bytearray(recorded.path.read_bytes())
    chunk, header = 0x06, 9
    at = 8
    while content[at] != chunk:
        at += header + int.from_bytes(content[at + 1 : at + 9], "little")
    data_length = (
        at + header + 8 + 8 + 8 + 4 + 4 + int.from_bytes(content[at + header + 28 : at + header + 32], "little")
    )
    content[data_length : data_length + 8] = length.to_bytes(8, "little")
    (tmp_path / "huge.mcap").write_bytes(content[:-1])  # without its end it is read from its beginning
    with pytest.raises(InputError, match="it ends within a record"):
        read_info(tmp_path / "huge.mcap")


def test_nothing_is_overwritten_unasked(recorded, partial):
    recover(partial)
    with pytest.raises(OutputError, match="--overwrite"):
        recover(partial)
    with pytest.raises(OutputError, match="the recording itself"):
        recover(partial, partial, overwrite=True)


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"", "not an MCAP file"), (b"PK\x03\x04 a zip", "not an MCAP file"), (b"\x89MCAP0\r\n", "no message")],
)
def test_what_is_no_recording_is_refused(tmp_path, content, message):
    path = tmp_path / "x.mcap"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        recover(path)
    with pytest.raises(InputError, match=message):
        read_info(path)
    assert [one.name for one in tmp_path.iterdir()] == ["x.mcap"]


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InputError, match=r"cannot read .*no\.mcap"):
        recover(tmp_path / "no.mcap")


def test_the_info_of_an_unclosed_file_says_so(recorded, partial):
    info = read_info(partial)
    assert info.damage is not None
    assert info.messages > 0
    assert info.as_dict()["complete"] is False
    assert info.as_dict()["run"] == recorded.info.name

import socket

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.evaluation.pool.framing import NOTE, VALUE, Inbox, pack, receive

CONTENTS = st.lists(st.tuples(st.sampled_from([NOTE, VALUE]), st.binary(max_size=300)), max_size=6)


@given(CONTENTS, st.integers(1, 40))
def test_messages_arrive_however_they_are_cut(messages, piece):
    stream = b"".join(pack(*message) for message in messages)
    ours, theirs = socket.socketpair()
    with ours, theirs:
        ours.setblocking(False)
        inbox, found = Inbox(ours), []
        for begin in range(0, len(stream), piece):
            theirs.sendall(stream[begin : begin + piece])
            assert inbox.take() == len(stream[begin : begin + piece])
            found.extend(inbox.messages())
        assert found == messages
        assert inbox.take() == 0
        theirs.close()
        assert inbox.take() is None


@given(CONTENTS)
def test_a_worker_receives_what_was_packed(messages):
    ours, theirs = socket.socketpair()
    with ours, theirs:
        for message in messages:
            theirs.sendall(pack(*message))
        theirs.close()
        assert [receive(ours) for _ in messages] == messages
        assert receive(ours) is None


@pytest.mark.parametrize("length", [1, 4, 6])
def test_a_message_that_was_cut_off_is_none(length):
    ours, theirs = socket.socketpair()
    with ours, theirs:
        theirs.sendall(pack(VALUE, b"whole")[:length])
        theirs.close()
        assert receive(ours) is None

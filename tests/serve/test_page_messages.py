import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.errors import InputError
from trundle.mission import DropBox, ReinitializeGlobal, Restart, SetGoal, SetPose, Speed
from trundle.serve.page_messages import Order, Setup, encode, encode_items, parse_message


def test_messages_of_the_page_are_read() -> None:
    goal = parse_message('{"type":"goal","pose":[1,2.5,null],"append":true}')
    assert isinstance(goal, Order)
    assert (goal.directive, goal.run) == (SetGoal((1.0, 2.5), append=True), None)
    speed = parse_message('{"type":"speed","factor":"max"}')
    assert isinstance(speed, Order)
    assert speed.directive == Speed(math.inf)
    box = parse_message('{"type":"box","x":1,"y":2,"yaw":0,"size":[0.5,0.5,1]}')
    assert isinstance(box, Order)
    assert box.directive == DropBox(1.0, 2.0, 0.0, (0.5, 0.5, 1.0))
    pose = parse_message('{"type":"pose","pose":[1,2,0.5],"covariance":[[0.25,0,0],[0,0.25,0],[0,0,0.07]],"run":2}')
    assert isinstance(pose, Order)
    variances = ((0.25, 0.0, 0.0), (0.0, 0.25, 0.0), (0.0, 0.0, 0.07))
    assert (pose.directive, pose.run) == (SetPose((1.0, 2.0, 0.5), variances), 2)
    search = parse_message('{"type":"reinitialize"}')
    assert isinstance(search, Order)
    assert search.directive == ReinitializeGlobal()
    restart = parse_message('{"type":"restart","seed":"next","run":3}')
    assert isinstance(restart, Order)
    assert (restart.directive, restart.run) == (Restart("next"), 3)
    setup = parse_message(
        '{"type":"setup","world":"office","robot":"jackal","seed":3,"start":[0,0,0],"goal":[1,1,null]}'
    )
    assert isinstance(setup, Setup)
    assert setup.goal == (1.0, 1.0, None)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "null",
        "{}",
        '{"type":"boom"}',
        '{"type":"goal"}',
        '{"type":"goal","pose":[1,2]}',
        '{"type":"goal","pose":[1,2,NaN]}',
        '{"type":"goal","pose":["1",2,0]}',
        '{"type":"goal","pose":[1e300,2,0]}',
        '{"type":"goal","pose":[1,2,0],"extra":1}',
        '{"type":"goal","pose":[true,2,0]}',
        '{"type":"pose","pose":[1,2,null]}',
        '{"type":"pose","pose":[1e300,2,0]}',
        '{"type":"pose","pose":[1,2,0],"covariance":[[1,0],[0,1]]}',
        '{"type":"pose","pose":[1,2,0],"covariance":[[-1,0,0],[0,1,0],[0,0,1]]}',
        '{"type":"reinitialize","why":"lost"}',
        '{"type":"speed","factor":0}',
        '{"type":"speed","factor":51}',
        '{"type":"speed","factor":"fast"}',
        '{"type":"manual","v":Infinity,"w":0}',
        '{"type":"speed","factor":true}',
        '{"type":"pause","paused":1}',
        '{"type":"pause","paused":true,"run":0}',
        '{"type":"step","periods":1000}',
        '{"type":"end","why":"it is over"}',
        '{"type":"goal","goal":[1,2]}',
        '{"type":"behavior","behavior":"spin"}',
        '{"type":"end","directive":{}}',
        '{"type":"restart","seed":-1}',
        '{"type":"restart","seed":1.5}',
        '{"type":"box","x":0,"y":0,"size":[0,1,1]}',
        '{"type":"setup","world":""}',
        '{"type":"drive","answer":"yes"}',
        '{"type":"ping","echo":"' + 65 * "x" + '"}',
        '{"type":"ping","echo":[[[[[[]]]]]]}',
        "[" * 5000,
    ],
)
def test_what_is_not_as_the_schema_says_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="message refused") as raised:
        parse_message(text)
    assert len(str(raised.value)) < 400


_JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=8,
)
_KINDS = ("setup", "preview", "goal", "pause", "step", "speed", "manual", "release", "restart", "box", "end", "drive")
_FIELDS = ("pose", "append", "paused", "factor", "v", "w", "seed", "x", "y", "yaw", "size", "answer", "world", "start")


@pytest.mark.slow
@given(st.sampled_from(_KINDS) | st.text(), st.dictionaries(st.sampled_from(_FIELDS), _JSON))
def test_whatever_comes_is_a_message_or_refused(kind: str, fields: dict[str, object]) -> None:
    try:
        message = parse_message(json.dumps({"type": kind, **fields}))
    except InputError:
        return
    assert message.type == kind


def test_numbers_that_json_does_not_have_are_null():
    text = encode({"a": [1.5, math.nan, (math.inf,)], "b": -math.inf})
    assert json.loads(text) == {"a": [1.5, None, [None]], "b": None}
    assert "\n" not in text
    assert encode_items([1, math.nan]) == "1,null"

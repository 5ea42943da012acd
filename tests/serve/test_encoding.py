import json
import math

from trundle.serve.encoding import encode, encode_items


def test_numbers_that_json_does_not_have_are_null():
    text = encode({"a": [1.5, math.nan, (math.inf,)], "b": -math.inf})
    assert json.loads(text) == {"a": [1.5, None, [None]], "b": None}
    assert "\n" not in text
    assert encode_items([1, math.nan]) == "1,null"

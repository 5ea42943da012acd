from __future__ import annotations

import pytest

from trundle.errors import WorldError
from trundle.files.xml_elements import MAX_DEPTH, parse_xml, read_xml

BOMB = """<?xml version="1.0"?>
<!DOCTYPE lolz [<!ENTITY lol "lol"><!ENTITY lol2 "&lol;&lol;&lol;">]>
<sdf>&lol2;</sdf>"""


def parse(text):
    return parse_xml("w.sdf", text if isinstance(text, bytes) else text.encode(), error=WorldError)


def test_elements_know_their_lines():
    root = parse("<a>\n  <b/>\n\n  <c x='1'>t</c></a>")
    assert [(child.tag, child.line) for child in root] == [("b", 2), ("c", 4)]
    assert root[1].text == "t"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BOMB, "w.sdf:2: a <!DOCTYPE"),
        ('<!DOCTYPE x SYSTEM "file:///etc/hostname"><x/>', "w.sdf:1: a <!DOCTYPE"),
        ("<a>\n<b></a>", "w.sdf:2:6: not XML: mismatched tag"),
        ("<a><b>", "not XML: no element found"),
        ("", "not XML: no element found"),
        ("<a>&b;</a>", "not XML: undefined entity"),
        (b"\x00\xff\x80", "not XML"),
        ("<?xml version='1.0' encoding='klingon'?><a/>", "not XML"),
        ("<a>" * (MAX_DEPTH + 1), f"elements nested more than {MAX_DEPTH} deep"),
    ],
)
def test_bad_xml_is_refused_with_its_line(text, message):
    with pytest.raises(WorldError) as caught:
        parse(text)
    assert message in str(caught.value)


def test_a_file_that_is_too_large_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setattr("trundle.files.xml_elements.MAX_BYTES", 10)
    (tmp_path / "w.sdf").write_text("<a>       </a>")
    with pytest.raises(WorldError, match="larger than the limit of"):
        read_xml(tmp_path / "w.sdf", error=WorldError)
    with pytest.raises(WorldError, match=r"cannot read .*gone\.sdf"):
        read_xml(tmp_path / "gone.sdf", error=WorldError)

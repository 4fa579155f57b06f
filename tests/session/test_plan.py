"""Planning of documents from their text."""

from pathlib import Path

import pytest

from kinesic.bml.block import BmlError, Speech
from kinesic.intent.manuscript.pieces import SpokenText
from kinesic.session.plan import plan, plan_document, plan_parts, plan_plain_text

NOD = '<bml id="b"><head id="nod" lexeme="NOD" stroke="1"/></bml>'


def test_plan_records_the_parse_duration_of_the_document(known):
    planned = plan(NOD, known)
    assert 0.0 < planned.parse_seconds < 10.0
    assert planned.setup is known


def test_parse_error_begins_with_the_source_name_and_line(known):
    with pytest.raises(BmlError, match=r"^nod\.bml:1:"):
        plan("<bml", known, source="nod.bml")


def test_plan_document_accepts_a_path_or_bml_text_and_records_the_source_name(known, tmp_path):
    file = tmp_path / "nod.bml"
    file.write_text(NOD, encoding="utf-8")
    for document, source in ((file, str(file)), (str(file), str(file)), (NOD, "<text>"), (NOD.encode(), "<text>")):
        planned = plan_document(document, known)
        assert planned.timeline.block.source == source
        assert [behaviour.id for behaviour in planned.timeline.block.behaviours] == ["nod"]
    text = tmp_path / "hello.txt"
    text.write_text("Hello.", encoding="utf-8")
    assert plan_document(text, known).timeline.block.source == str(text)
    for document in (file, text):
        assert plan_document(document, known, source="mine").timeline.block.source == "mine"


def test_missing_document_error_asks_for_a_path_or_bml_text(known, tmp_path):
    with pytest.raises(BmlError, match="give a path, or BML text that begins with <"):
        plan_document(tmp_path / "none.bml", known)


def test_plan_of_plain_text_contains_speech_and_records_the_source_name(known):
    planned = plan_plain_text("Hello there.", known, source="hello.txt")
    assert {behaviour.type for behaviour in planned.timeline.block.behaviours} >= {"speech"}
    assert planned.timeline.block.source == "hello.txt"


def test_gestures_of_a_long_text_do_not_repeat_in_the_next_part(known):
    parts = [SpokenText("No, I did not say that."), SpokenText("No, I did not do that.")]
    blocks = [planned.timeline.block for planned in plan_parts(parts, known, source="a.txt")]
    first, second = ([b.action.lexeme for b in block.behaviours if b.type == "gesture"] for block in blocks)
    assert first
    assert second
    assert not set(first) & set(second)
    assert [block.source for block in blocks] == ["a.txt, part 1 of 2", "a.txt, part 2 of 2"]


@pytest.mark.parametrize(
    ("name", "content", "warnings"),
    [
        ("a.xml", b'<?xml version="1.0"?><speak>Hello <sub alias="there">t</sub>.</speak>', ()),
        ("a.md", b"# Hello\n\nthere", ()),
        ("a.txt", "Hello th\xe9re".encode("cp1252"), ("cp1252",)),
        ("a.txt", "Hello there".encode("utf-16"), ()),
        ("a.srt", b"1\n00:00:01,000 --> 00:00:02,000\nHello there.\n", ()),
        ("a.txt", b"Hello there. (juggles plates)", ("juggles plates",)),
    ],
)
def test_text_files_of_several_formats_and_encodings_are_spoken_without_markup(
    known, tmp_path: Path, name, content, warnings
):
    file = tmp_path / name
    file.write_bytes(content)
    block = plan_document(file, known).timeline.block
    scripts = [behaviour.action.script for behaviour in block.behaviours if isinstance(behaviour.action, Speech)]
    spoken = "".join(letter for script in scripts for letter in script.text if letter.isalpha())
    assert spoken.replace("\xe9", "e") == "Hellothere"
    notices = [notice.text for notice in block.notices]
    assert len(notices) == len(warnings)
    assert all(expected in notice for expected, notice in zip(warnings, notices, strict=True))

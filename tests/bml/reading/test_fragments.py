"""Tests of the translation of SmartBody fragments."""

import json
import os
from collections import Counter
from pathlib import Path

import pytest

from kinesic.bml.block import Action, BmlError, Custom, Face, Gaze, Gesture, Head, Pointing, Posture, Speech, SyncRef
from kinesic.bml.parse import parse

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
FRAGMENTS_FILE = CORPUS_FOLDER / "smartbody" / "fragments.jsonl"
BML_ELEMENTS = ("gaze", "head", "gesture", "face", "speech")  # SmartBody elements with the name of a BML element


@pytest.mark.parametrize(
    ("text", "action"),
    [
        ('<gaze target="t"/>', Gaze("t", shift=True)),
        ('<gaze target="t" end="3"/>', Gaze("t")),
        ('<gaze target="t" sbm:joint-range="EYES NECK"/>', Gaze("t", "NECK", shift=True)),
        ('<gaze target="t" sbm:joint-range="eyes chest back"/>', Gaze("t", "WAIST", shift=True)),
        ('<gaze sbm:target-pos="1 2 3"/>', Gaze("3 1 2", shift=True)),
        ('<head type="SHAKE" repeats="5"/>', Head("SHAKE", 5)),
        ('<face type="facs" au="1_left" amount="1"/>', Face((), 1, "left", 1.0)),
        ('<face type="facs" au="12" amount=".5"/>', Face((), 12, "both", 0.5)),
        ('<gesture lexeme="DEICTIC" type="YOU"/>', Gesture("YOU_DEICTIC")),
        ('<gesture type="BEAT" mode="LEFT_HAND"/>', Gesture("BEAT", "left")),
        ('<gesture name="Someone@Stand01_BeatLow01"/>', Gesture("BeatLow01")),
        ('<body posture="Someone@Idle01"/>', Posture(poses=(("WHOLEBODY", "Idle01"),), shift=True)),
        ('<sbm:reach sbm:action="point-at" target="t" sbm:reach-type="left"/>', Pointing("t", "left")),
        ('<sbm:reach sbm:action="touch" target="t"/>', Custom("sbm:reach")),
        ('<saccade mode="talk"/>', Custom("saccade")),
        ('<?xml version="1.0"?><head type="NOD"/>', Head("NOD")),
    ],
)
def test_smartbody_fragment_is_translated_into_a_behaviour_action(text: str, action: Action) -> None:
    block = parse(text)
    assert [behaviour.action for behaviour in block.behaviours] == [action]
    assert block.dialect == "smartbody"


def test_sequence_of_smartbody_elements_is_read_as_one_block() -> None:
    block = parse('<speech type="text/plain">Hi <sync id="m"/>there</speech> + <face au="1"/> <head type="NOD"/>')
    speech = block.behaviours[0].action
    assert isinstance(speech, Speech)
    assert (speech.script.text, [mark.name for mark in speech.script.marks]) == ("Hi there", ["m"])
    assert [behaviour.type for behaviour in block.behaviours] == ["speech", "face", "head"]
    assert block.notices == ()


def test_behaviour_type_of_a_smartbody_fragment_is_its_element_name() -> None:
    assert [block.type for block in parse('<gaze target="t"/><body posture="Idle"/>').behaviours] == ["gaze", "body"]


def test_time_hint_of_a_smartbody_gaze_is_the_time_until_its_target() -> None:
    gazes = '<gaze id="a" target="t" sbm:time-hint="0.7"/><gaze id="b" target="t" sbm:time-hint=" 0.5" end="3"/>'
    shift, look = parse(gazes).behaviours
    assert shift.syncs == {"end": SyncRef("block", "a", "start", offset=0.7)}
    assert look.syncs["ready"] == SyncRef("block", "b", "start", offset=0.5)


def test_hold_durations_of_a_smartbody_gesture_become_sync_points() -> None:
    (behaviour,) = parse('<gesture id="g" type="BEAT" prestroke_hold="0.5" poststroke_hold="2"/>').behaviours
    assert behaviour.syncs == {
        "strokeStart": SyncRef("block", "g", "ready", offset=0.5),
        "relax": SyncRef("block", "g", "strokeEnd", offset=2.0),
    }


def test_smartbody_posture_shift_ends_at_ready_unless_ready_is_0() -> None:
    one, two = parse('<body posture="a" start=".4" ready="0" relax="0"/><body posture="b" ready="2"/>').behaviours
    assert {sync: ref.offset for sync, ref in one.syncs.items()} == {"start": 0.4}
    assert {sync: ref.offset for sync, ref in two.syncs.items()} == {"end": 2.0}


def test_unsupported_attributes_of_a_smartbody_fragment_give_a_notice_with_their_name() -> None:
    block = parse('<gaze target="t" sbm:joint-speed="800"/><head type="NOD" velocity="2"/>')
    assert [notice.text.split()[2] for notice in block.notices] == ["sbm:joint-speed", "velocity"]


def test_behaviours_and_errors_of_a_smartbody_fragment_have_line_and_column_of_the_document() -> None:
    one, two = parse('<head type="NOD"/>\n  <gaze target="t"/>').behaviours
    assert [(block.place.line, block.place.column) for block in (one, two)] == [(1, 1), (2, 3)]
    with pytest.raises(BmlError, match=r"^f:1:11: not XML: mismatched tag; "):
        parse("<speech></head>", source="f")


@pytest.mark.parametrize("text", ["<gestuary><gesture/></gestuary>", "<html/>", "<foo:gaze2/>"])
def test_documents_without_bml_or_behaviour_elements_are_rejected(text: str) -> None:
    with pytest.raises(BmlError, match="contains no <bml>"):
        parse(text)


def test_commented_behaviour_does_not_make_a_document_a_smartbody_fragment() -> None:
    assert parse('<!-- <head/> --><bml id="b"><gaze id="g" target="t"/></bml>').dialect == "none"


def test_bml_elements_of_corpus_fragments_are_read_as_known_actions() -> None:
    if not FRAGMENTS_FILE.exists():
        pytest.skip(f"no corpus at {CORPUS_FOLDER}")
    rows = [json.loads(line) for line in FRAGMENTS_FILE.read_text(encoding="utf-8").splitlines()]
    text: Counter[str] = Counter()
    understood: Counter[str] = Counter()
    for row in rows:
        if row["dynamic"]:
            continue
        for behaviour in parse(row["bml"]).behaviours:
            text[behaviour.type] += 1
            understood[behaviour.type] += not isinstance(behaviour.action, Custom)
    assert sum(text.values()) > 140
    assert all(understood[name] == text[name] > 0 for name in BML_ELEMENTS)

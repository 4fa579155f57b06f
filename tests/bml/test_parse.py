"""Tests of parsing BML 1.0, the drafts and Greta's dialect."""

import pytest

from kinesic.bml.block import (
    DEFAULT_BOUNDS,
    Block,
    BmlError,
    Composition,
    Custom,
    Face,
    Gaze,
    Gesture,
    Head,
    HeadDirectionShift,
    Locomotion,
    Manner,
    NoticeType,
    Place,
    Pointing,
    Posture,
    Precedence,
    Speech,
    Synchronize,
    SyncRef,
    Torso,
    Wait,
)
from kinesic.bml.parse import parse
from kinesic.body.utterance import Mark

BML_TEMPLATE = (
    'xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:ext="http://www.bml-initiative.org/bml/coreextensions-1.0"'
)


def parse_block(content: str, attributes: str = 'id="b"') -> Block:
    return parse(f"<bml {BML_TEMPLATE} {attributes}>{content}</bml>", source="f.xml")


@pytest.mark.parametrize(
    ("xml", "action"),
    [
        ('<gesture id="x" lexeme="BEAT" mode="LEFT_HAND"/>', Gesture("BEAT", "left")),
        ('<gesture id="x" lexeme="WAVE" mode="BOTH_HANDS" target="t"/>', Gesture("WAVE", "both", "t")),
        ('<gesture id="x" type="BEAT" hand="RIGHT"/>', Gesture("BEAT", "right")),
        ('<gesture id="x" type="POINT" target="t"/>', Pointing("t")),
        ('<gesture id="x"/>', Gesture("")),
        ('<pointing id="x" target="t" mode="RIGHT_HAND"/>', Pointing("t", "right")),
        ('<head id="x" lexeme="NOD" repetition="2" amount="0.3"/>', Head("NOD", 2, 0.3)),
        ('<head id="x" action="ROTATION" rotation="SHAKE"/>', Head("SHAKE")),
        ('<headDirectionShift id="x" target="t"/>', HeadDirectionShift("t")),
        (
            '<gaze id="x" target="t" influence="waist" offsetAngle="5" offsetDirection="UP"/>',
            Gaze("t", "WAIST", 5.0, "UP"),
        ),
        ('<gazeShift id="x" target="t"/>', Gaze("t", shift=True)),
        ('<faceLexeme id="x" lexeme="SMILE" amount="0.8"/>', Face(("SMILE",), amount=0.8)),
        ('<ext:faceFacs id="x" au="12" side="LEFT" amount="1"/>', Face((), 12, "left", 1.0)),
        ('<face id="x"><lexeme lexeme="A" amount="0.2"/><lexeme lexeme="B"/></face>', Face(("A", "B"), amount=0.2)),
        ('<face id="x" type="FACS" au="1" side="RIGHT" amount="1"/>', Face((), 1, "right", 1.0)),
        ('<faceShift id="x" lexeme="SMILE"/>', Face(("SMILE",), shift=True)),
        (
            '<posture id="x"><stance type="SITTING"/><pose part="ARMS" lexeme="ARMS_OPEN"/></posture>',
            Posture("SITTING", (("ARMS", "ARMS_OPEN"),)),
        ),
        ('<postureShift id="x"><stance type="STANDING"/></postureShift>', Posture("STANDING", shift=True)),
        ('<locomotion id="x" target="door"/>', Locomotion("door")),
        ('<wait id="x" max-wait="2"/>', Wait(2.0)),
        ('<wait id="x"/>', Wait()),
        ('<torso id="x" lexeme="BodyLean"/>', Torso("BodyLean")),
        ('<lips id="x" viseme="a"/>', Custom("lips")),
        ('<z:dance xmlns:z="urn:z" id="x"/>', Custom("z:dance")),
        ('<gesture xmlns="urn:z" id="x" lexeme="BEAT"/>', Custom("gesture")),
        ('<undeclared:gesture id="x" lexeme="BEAT"/>', Custom("undeclared:gesture")),
    ],
)
def test_bml_behaviour_elements_become_actions(xml: str, action: object) -> None:
    (behaviour,) = parse_block(xml).behaviours
    assert behaviour.action == action
    assert behaviour.id == "x"


def test_sync_marks_within_a_speech_are_read_with_their_text_positions() -> None:
    text = "<text>  Hey <sync id='a'/> punk,\n what<sync id='b'/> do<sync id='c'/></text>"
    (speech,) = parse_block(f'<speech id="s">{text}</speech>').behaviours
    assert speech.action == Speech(script=speech.action.script)
    assert speech.action.script.text == "Hey punk, what do"
    assert speech.action.script.marks == (Mark("a", 4), Mark("b", 14), Mark("c", 17))


def test_ssml_description_replaces_speech_text() -> None:
    ssml = '<description priority="2" type="application/ssml+xml"><speak>A <mark name="m"/>b</speak></description>'
    other = '<description priority="9" type="audio/x-wav">noise.wav</description>'
    (speech,) = parse_block(f'<speech id="s"><text>plain</text>{other}{ssml}</speech>').behaviours
    assert (speech.action.script.text, speech.action.script.marks) == ("A b", (Mark("m", 2),))
    (speech,) = parse_block(f'<speech id="s"><text>plain</text>{other}</speech>').behaviours
    assert speech.action.script.text == "plain"


def test_short_and_empty_speech_is_read() -> None:
    first, second = parse_block('<speech id="s"><text>a</text></speech><speech id="t"/>').behaviours
    assert (first.action.script.text, second.action.script.text) == ("a", "")


def test_sync_references_document_positions_and_required_flag_are_read() -> None:
    block = parse_block(
        '\n <required>\n  <gesture id="g" lexeme="B" stroke="s:m+1" end="4"/></required><speech id="s"/>'
    )
    g, s = block.behaviours
    assert g.syncs == {"stroke": SyncRef("b", "s", "m", offset=1.0), "end": SyncRef("b", "bml", "start", offset=4.0)}
    assert (g.place, g.required, s.required) == (Place(3, 3), True, False)


def test_constraint_elements_become_time_constraints() -> None:
    block = parse_block(
        '<gesture id="g" lexeme="B"/><head id="h" lexeme="NOD"/><constraint>'
        '<synchronize><sync ref="g:stroke"/><sync ref="h:stroke"/></synchronize>'
        '<before ref="g:end"><sync ref="h:start"/><sync ref="h:end"/></before></constraint>'
        '<required><constraint><after ref="1"><sync ref="g:start"/></after></constraint></required>'
        '<constraint><synchronize ref="g:stroke"><sync ref="10"/></synchronize></constraint>'
    )
    g, h = (lambda sync: SyncRef("b", "g", sync)), (lambda sync: SyncRef("b", "h", sync))
    synchronize, *previous, after, draft = block.constraints
    assert isinstance(synchronize, Synchronize)
    assert synchronize.refs == (g("stroke"), h("stroke"))
    assert [(o.earlier, o.later) for o in previous] == [(h("start"), (g("end"),)), (h("end"), (g("end"),))]
    assert isinstance(after, Precedence)
    assert (after.earlier.offset, after.later, after.required) == (1.0, (g("start"),), True)
    assert draft.refs == (g("stroke"), SyncRef("b", "bml", "start", offset=10.0))


def test_after_and_before_in_attributes_become_precedences() -> None:
    block = parse_block('<gesture id="g" lexeme="B" start="after(h:end)" end="before(9)"/><head id="h" lexeme="NOD"/>')
    assert block.behaviours[0].syncs == {}
    assert [(o.earlier.sync, o.later[0].sync) for o in block.constraints] == [("end", "start"), ("end", "start")]


@pytest.mark.parametrize(
    ("text", "composition", "notices"),
    [
        ("", Composition.MERGE, 0),
        ("merge", Composition.MERGE, 0),
        ("blend", Composition.MERGE, 0),
        ("APPEND", Composition.APPEND, 0),
        ("replace", Composition.REPLACE, 0),
        ("APPEND-AFTER(a,b)", Composition.APPEND, 0),
        ("overlap", Composition.MERGE, 1),
    ],
)
def test_composition_attribute_of_a_block_is_read(text: str, composition: Composition, notices: int) -> None:
    block = parse_block("", f'id="b" composition="{text}" characterId="c"')
    assert (block.composition, len(block.notices), block.character) == (composition, notices, "c")


def test_repeated_unknown_extension_attribute_gives_one_notice() -> None:
    block = parse_block('<head id="h" lexeme="NOD" z:a="1"/><head id="i" lexeme="NOD" z:a="1" z:b="2" xml:lang="en"/>')
    assert [n.type for n in block.notices] == [NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED] * 2
    assert "z:a" in block.notices[0].text


def test_missing_behaviour_ids_are_generated() -> None:
    block = parse(f"<bml {BML_TEMPLATE}/>")
    assert [n.type for n in block.notices] == [NoticeType.PARSING_FAILURE]
    assert parse("<bml/>").notices == ()
    assert len(parse("<bml/>", dialect="draft").notices) == 1
    assert [b.id for b in parse('<bml><head/><head id="head.1"/></bml>').behaviours] == ["head.2", "head.1"]


def test_duplicate_ids_get_a_suffix_and_references_use_the_first() -> None:
    block = parse_block(
        '<head id="h" lexeme="NOD"/><head id="h" lexeme="NOD"/><gesture id="g" lexeme="B" start="h:end"/>'
    )
    assert [b.id for b in block.behaviours] == ["h", "h.2", "g"]
    assert block.behaviours[2].syncs["start"].behaviour == "h"
    assert [n.id for n in block.notices] == ["b:h.2"]


def test_hyphen_in_a_referenced_behaviour_id_gives_a_notice() -> None:
    block = parse_block('<head id="my-nod" lexeme="NOD"/><gesture id="g" lexeme="B" start="my-nod:end-0.5"/>')
    assert block.behaviours[1].syncs["start"] == SyncRef("b", "my-nod", "end", offset=-0.5)
    assert "my-nod" in block.notices[0].text


GRETA_DOCUMENT = """<?xml version="1.0" encoding="ISO-8859-1"?>
<!DOCTYPE fml-apml SYSTEM "fml-apml.dtd" []>
<fml-apml composition="append"><bml>
 <speech id="s1" start="0.0" language="french" type="SAPI4" text="">
  <description level="1" type="gretabml"><reference>tmp/x.pho</reference></description>
  <tm id="tm1"/>C'est <tm id="tm2"/>\u00e9t\u00e9.<tm id="tm2"/>
  <pitchaccent id="pa" type="Hstar" start="s1:tm1" end="s1:tm9"/><boundary id="bo" type="LL" start="s1:tm2"/>
  <gaze start="1.0" end="2.0" offsetDirection="DOWN" offsetAngle="25" type="GAZE" modality="HEAD"/>
 </speech>
 <gesture id="g" lexeme="some" strokeENd="-0.25" ready="tm1 + 0.5"><description priority="1" type="gretabml">
  <reference>performative=ask_B</reference><intensity>1.0</intensity><SPC.value>0.4</SPC.value><TMP.value>-0.7
  </TMP.value><OPN.value>5.0</OPN.value></description></gesture>
 <greta:torso id="t" lexeme="BodyLean" start="0">
 <greta:description type="gretabml"><greta:PWR.value>0.5</greta:PWR.value>
 </greta:description></greta:torso>
 <shoulder id="sh" lexeme="up" start="1"/>
</bml><fml/></fml-apml>"""


def test_bml_of_a_greta_document_is_read_as_speech_gaze_gesture_and_torso_actions() -> None:
    block = parse(GRETA_DOCUMENT.encode("latin-1"))
    speech, gaze, gesture, torso, shoulder = block.behaviours
    assert (block.dialect, block.composition) == ("fml-apml", Composition.APPEND)
    assert (speech.action.script.text, speech.action.script.language) == ("C'est \u00e9t\u00e9.", "fr")
    assert speech.action.script.marks == (Mark("tm1", 0), Mark("tm2", 6))
    assert gaze.action == Gaze(None, "HEAD", 25.0, "DOWN")
    assert gesture.action == Gesture("ask_B")
    assert gesture.syncs["strokeEnd"] == SyncRef("block", "bml", "start", offset=-0.25)
    assert gesture.syncs["ready"] == SyncRef("block", "s1", "tm1", offset=0.5)
    assert gesture.manner == Manner(spatial=0.4, temporal=-0.7, openness=1.0, intensity=1.0)
    assert (torso.action, torso.manner.power) == (Torso("BodyLean"), 0.5)
    assert shoulder.action == Custom("shoulder")
    notices = [n for n in block.notices if n.id != "block"]
    assert sorted(n.id for n in notices) == ["block:g", "block:s1"]  # openness is clipped, tm2 is duplicate


def test_draft_namespace_and_rest_prefix_of_a_lexeme_are_recognised() -> None:
    draft = parse('<bml xmlns="http://www.mindmakers.org/projects/BML" character="C"><speech xmlns="" id="s"/></bml>')
    assert (draft.dialect, draft.character) == ("draft", "C")
    assert isinstance(draft.behaviours[0].action, Speech)
    assert parse('<bml><head id="h" lexeme="rest=Lap"/></bml>').behaviours[0].action == Head("Lap")


@pytest.mark.parametrize(
    ("text", "place", "problem"),
    [
        ("<fml/>", "1:1", "no <bml>"),
        ("<x><bml/><bml/></x>", "1:10", "a second <bml>: <x> contains 2"),
        ("<bml/>\n<!-- 2 --><bml/>", "2:11", "behind the first"),
        ('<bml/>\n<?xml version="1.0"?>\n<BML/>', "2:1", "a second <bml> behind the first"),
        ("<bml/> </bye>", "1:9", "not well-formed"),
        ('<bml>\n<head id="h" start="nope:end"/></bml>', "2:1", "no behaviour 'nope'"),
        ('<bml><head id="h" start="1e9"/></bml>', "1:6", "out of range"),
        ('<bml><head id="h" start="NaN"/></bml>', "1:6", "not a sync reference"),
        ('<bml><head id="h" start="h:relax:2"/></bml>', "1:6", "not a sync reference"),
        ('<bml><head id="h" amount="inf"/></bml>', "1:6", "out of range"),
        ('<bml><head id="h" amount="much"/></bml>', "1:6", "not a number"),
        ('<bml><head id="h" repetition="1e6"/></bml>', "1:6", "out of range"),
        ('<bml><head id="h" repetition="1.5"/></bml>', "1:6", "not an integer"),
        ('<bml><face id="f" au="0"/></bml>', "1:6", "not an integer"),
        ('<bml><wait id="w" duration="-1"/></bml>', "1:6", "not a valid duration"),
        ('<bml><wait id="w" duration="2000"/></bml>', "1:6", "not a valid duration"),
        ("<bml><constraint><synchronize><sync/></synchronize></constraint></bml>", "1:31", "not a sync reference"),
        ('<bml><constraint><after ref="x:end"><sync ref="1"/></after></constraint></bml>', "1:18", "no behaviour 'x'"),
        (
            '<bml><head id="g"><description type="gretabml"><SPC.value>nan</SPC.value></description></head></bml>',
            "1:48",
            "out of range",
        ),
    ],
)
def test_invalid_documents_are_rejected_with_line_and_column(text: str, place: str, problem: str) -> None:
    with pytest.raises(BmlError, match=f"^f.xml:{place}: .*{problem}.*; .+"):
        parse(text, source="f.xml")


def test_document_with_too_many_behaviours_is_rejected() -> None:
    assert len(parse(f"<bml>{'<head/>' * DEFAULT_BOUNDS.behaviours}</bml>").behaviours) == DEFAULT_BOUNDS.behaviours
    with pytest.raises(BmlError, match="the limit is 1000"):
        parse(f"<bml>{'<head/>' * (DEFAULT_BOUNDS.behaviours + 1)}</bml>")


def test_strict_parsing_rejects_unknown_behaviours() -> None:
    with pytest.raises(BmlError, match=r"known behaviours: .*gesture"):
        parse('<bml><dance id="d"/></bml>', strict=True)


def test_sync_references_to_other_blocks_are_accepted_without_a_check() -> None:
    block = parse_block('<head id="h" lexeme="NOD" start="other:x:end"/>')
    assert block.behaviours[0].syncs["start"] == SyncRef("other", "x", "end")


def test_block_without_id_gets_a_unique_one():
    text = f"<bml {BML_TEMPLATE}/>"
    assert [parse(text, known_blocks=ids).id for ids in ((), ("block",), ("block", "block.2"))] == [
        "block",
        "block.2",
        "block.3",
    ]

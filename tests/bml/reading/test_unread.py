"""Tests of notices about ineffective parts of a document."""

import pytest

from kinesic.bml.parse import parse


def notices(text: str) -> list[str]:
    return [notice.text for notice in parse(text).notices]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ('<head id="h" lexeme="NOD" speed="2"/><head id="i" lexeme="NOD" speed="3"/>', ["attribute speed of <head>"]),
        ('<head id="h" lexeme="NOD" x:speed="2"/>', ["attribute x:speed"]),
        ('<head id="h" lexeme="NOD">now<style/></head>', ["text 'now' in <head>", "<style> (line 1) in <head>"]),
        ('<face id="f"><lexeme lexeme="joy" colour="red"/></face>', ["attribute colour of <lexeme>"]),
        ('<face id="f"><facs au="1"/><lips/></face>', ["<lips> (line 1) in <face>"]),
        ('<posture id="p"><stance type="SITTING">deep</stance></posture>', ["text 'deep' in <stance>"]),
        ('<constraint id="c"><meanwhile/></constraint>', ["<meanwhile> (line 1) in <constraint>"]),
        ('<constraint><after ref="1"><tm ref="2"/></after></constraint>', ["<tm> (line 1) in <after>"]),
        ('<required strict="yes"><wait id="w"/>never</required>', ["attribute strict", "text 'never' in <required>"]),
        ("Good day<wait id='w'/>", ["text 'Good day' in <bml>"]),
        ('<sync id="m"/><description type="x"/>', ["<sync> (line 1) in <bml>", "<description> (line 1) in <bml>"]),
        ('<gaze id="z" target="user" type="AVERT"/>', ["the type 'AVERT' of <gaze>"]),
        ('<head id="h" rotation="NOD" action="ORIENTATION"/>', ["the action 'ORIENTATION' of <head>"]),
        ('<gesture id="g" lexeme="beat" type="BEAT"/><gesture id="h" lexeme="wave" type="BEAT"/>', ["type 'BEAT'"]),
        ('<gesture id="g" mode="LEFT_HAND" hand="RIGHT_HAND"/>', ["the hand 'RIGHT_HAND' of <gesture>"]),
        ('<gesture id="g"><description type="lights"><on/></description></gesture>', ["description of type 'lights'"]),
        (
            '<gesture id="g"><description type="gretabml"><PWR.value>0.1</PWR.value><SPEED.value>1</SPEED.value>'
            "</description></gesture>",
            ["<SPEED.value> (line 1) in <description>"],
        ),
        ('<gaze id="z" target="user" offsetAngle="20"/>', ["the offsetAngle '20' of <gaze>"]),
        (
            '<gazeShift id="z" target="user" offsetAngle="9" offsetDirection="NONE"/>',
            ["offsetAngle '9'"],
        ),
        ('<gaze id="z" target="user" offsetDirection="UP"/>', ["the offsetDirection 'UP' of <gaze>"]),
        ('<speech id="s" text="Bye"><text>Hi</text></speech>', ["the text 'Bye' of <speech>"]),
        ('<speech id="s"><text>Hi <prosody rate="fast" contour="(0%,+9)">you</prosody></text></speech>', ["contour"]),
        (
            '<speech id="s"><text><say-as interpret-as="date" format="mdy" detail="2">1</say-as></text></speech>',
            ["the interpret-as 'date'", "the format 'mdy'", "the detail '2'"],
        ),
        ('<speech id="s" voice="Anna">Hi</speech>', ["the voice 'Anna' of <speech>"]),
        ('<speech id="s"><text>Hi <laugh/>you</text></speech>', ["<laugh> (line 1) in <text>"]),
        ('<speech id="s"><text>Hi <m:loud>you</m:loud></text></speech>', ["<m:loud> (line 1) in <text>"]),
        ('<speech id="s"><text>Hi <break time="1s" loud="1"/></text></speech>', ["attribute loud of <break>"]),
        ('<speech id="s">lost<text>Hi</text><tm id="m"/></speech>', ["text 'lost' in <speech>", "<tm> (line 1) in"]),
        ('<speech id="s"><text>Hi</text><text>you</text></speech>', ["<text> (line 1) in <speech>"]),
        (
            '<speech id="s">Hi<pitchaccent id="p"/><pitchaccent id="q"/></speech>',
            ["<pitchaccent> (line 1) in <speech>"],
        ),
    ],
)
def test_each_kind_of_ignored_document_part_gives_one_notice(content: str, words: list[str]) -> None:
    texts = notices(f'<bml id="b">{content}</bml>')
    assert len(texts) == len(words), texts
    for part in words:
        assert any(part in text for text in texts), (part, texts)


@pytest.mark.parametrize(
    "content",
    [
        '<gesture id="g" lexeme="beat" type="LEXICALIZED" mode="LEFT_HAND" xml:lang="en"/>',
        '<face id="f" type="FACS" au="1" side="LEFT"/><gaze id="z" type="AT" target="user"/>',
        '<face id="f"><lexeme lexeme="joy"/><description type="kinesic"><power>0.1</power></description></face>',
        '<head id="h" action="ROTATION" rotation="X"/>',
        '<gaze id="z" target="user" offsetAngle="20" offsetDirection="UP"/><speech id="s" text="Hi"/>',
        '<speech id="s"><text><say-as interpret-as="tts:digits" detail="2">12</say-as>'
        '<prosody range="high">you</prosody></text></speech>',
        '<speech id="s"><head id="h" lexeme="NOD"/><text>Hi <mark name="m"/><emphasis level="strong">you</emphasis>'
        '</text><description type="audio/wav" ref="a.wav"><sync id="m" time="1"/></description></speech>',
        '<speech id="s"><text>Hi</text><description priority="1" type="application/ssml+xml">'
        '<speak version="1.0"><s xml:lang="fr">Salut</s></speak></description></speech>',
        '<gesture id="g"><description priority="1" type="x"><head lexeme="NOD"/></description></gesture>',
        '<x:dance id="d" speed="1"><step/>left</x:dance>',
    ],
)
def test_supported_parts_of_a_document_give_no_notice(content: str) -> None:
    assert [text for text in notices(f'<bml id="b">{content}</bml>') if "a.wav" not in text] == []


def test_ignored_document_elements_and_block_attributes_give_one_notice() -> None:
    text = '<fml-apml><fml><emotion/></fml><bml id="b"><wait id="w"/></bml><fml/></fml-apml>'
    assert notices(text) == ["<fml> (line 1) in <fml-apml> has no effect and is ignored"]
    assert len(notices('<bml id="b" agent="A" mood="good"><wait id="w"/></bml>')) == 1
    text = '{"id": "b", "mood": "good", "notes": [1, 2], "behaviours": [{"type": "wait", "id": "w"}]}'
    assert (len(notices(text)), [b.type for b in parse(text).behaviours]) == (1, ["notes", "wait"])


def test_long_ignored_text_is_shortened_in_the_notice() -> None:
    (texts,) = notices(f'<bml id="b">{"very " * 20}<wait id="w"/></bml>')
    assert "the text 'very very very very very very ...' in <bml>" in texts


def test_text_in_unknown_speech_markup_is_spoken() -> None:
    (speech,) = parse('<bml id="b"><speech id="s">Hi <m:loud>you</m:loud> there</speech></bml>').behaviours
    assert speech.action.script.text == "Hi you there"

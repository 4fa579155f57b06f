from pathlib import Path

import pytest

from kinesic.bml.block import BmlError, Speech
from kinesic.bml.parse import parse
from kinesic.body.utterance import Emphasis, Mark, Pause, Recording, Script

BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" id="b" {}>{}</bml>'


def speech(inside: str, attributes: str = "") -> Speech:
    (behaviour,) = parse(BML.format("", f'<speech id="s" {attributes}>{inside}</speech>')).behaviours
    assert isinstance(behaviour.action, Speech)
    return behaviour.action


def script(inside: str, attributes: str = "") -> Script:
    return speech(inside, attributes).script


def ssml(inside: str) -> Script:
    return script(f'<text>plain</text><description type="application/ssml+xml"><speak>{inside}</speak></description>')


@pytest.mark.parametrize("read", [ssml, lambda inside: script(f"<text>{inside}</text>")])
def test_breaks_prosody_and_emphasis_are_passed_on(read):
    found = read(
        'One <prosody rate="slow" pitch="+10%" volume="soft">two <emphasis level="strong">three</emphasis></prosody>'
        '<break time="400ms"/> four'
    )
    assert found.text == "One two three four"
    assert found.pauses == (Pause(13, 0.4),)
    assert found.emphases == (
        Emphasis(4, 13, "prosody", (("rate", "slow"), ("pitch", "+10%"), ("volume", "soft"))),
        Emphasis(8, 13, "emphasis", (("level", "strong"),)),
    )


@pytest.mark.parametrize(
    ("written", "seconds"),
    [
        ('time="500ms"', 0.5),
        ('time="1.5s"', 1.5),
        ('time=".25s"', 0.25),
        ('strength="strong"', 0.5),
        ("", 0.25),
        ('strength="none"', None),
        ('time="0s"', None),
    ],
)
def test_a_break_takes_its_time_or_what_its_strength_means(written: str, seconds: float | None):
    expected = () if seconds is None else (Pause(4, seconds),)
    assert ssml(f"One <break {written}/>two").pauses == expected


@pytest.mark.parametrize("written", ['time="soon"', 'time="-1s"', 'time="1e9s"', 'strength="huge"', 'time="100s"'])
def test_a_break_that_is_none_is_passed_over_with_a_notice(written: str):
    block = parse(BML.format("", f'<speech id="s"><text>One <break {written}/>two</text></speech>'))
    (behaviour,) = block.behaviours
    assert isinstance(behaviour.action, Speech)
    assert behaviour.action.script.pauses == ()
    assert [(notice.id, "break" in notice.text) for notice in block.notices] == [("b:s", True)]


def test_marks_keep_their_side_of_a_break():
    found = ssml('One <mark name="a"/><break time="1s"/><mark name="b"/><break time="2s"/>two<mark name="c"/>')
    assert found.stops() == (Mark("a", 4), Pause(4, 1.0, 1), Mark("b", 4), Pause(4, 2.0, 2), Mark("c", 7))


def test_an_alias_is_said_in_place_of_what_is_written():
    assert ssml('The <sub alias="World Wide Web">WWW</sub> is old').text == "The World Wide Web is old"


def test_a_change_of_language_is_passed_on():
    found = ssml('One <lang xml:lang="fr">bonjour</lang> <voice gender="female">two</voice> <s xml:lang="de">drei</s>')
    assert found.text == "One bonjour two drei"
    assert [(e.begin, e.end, e.attributes) for e in found.emphases] == [
        (4, 11, (("xml:lang", "fr"),)),
        (16, 20, (("xml:lang", "de"),)),
    ]


@pytest.mark.parametrize(
    ("written", "tag"), [("english", "en"), ("FRENCH", "fr"), ("pt-BR", "pt-br"), ("", "en"), ("Klingon", "klingon")]
)
def test_a_language_has_a_name_or_a_tag(written: str, tag: str):
    assert script("<text>x</text>", f'language="{written}"').language == tag


# what waits


@pytest.mark.parametrize(
    ("written", "seconds"), [("true", 2.0), ("false", 0.0), ("0.4", 0.4), ("0", 0.0), (" TRUE ", 2.0)]
)
def test_a_speech_and_a_block_say_how_long_a_word_may_wait(written: str, seconds: float):
    assert speech("<text>x</text>", f'kinesic:pause="{written}"').pause == seconds
    block = parse(BML.format(f'kinesic:pause="{written}"', '<speech id="s"><text>x</text></speech>'))
    assert block.pause == seconds
    assert block.notices == ()
    assert speech("<text>x</text>").pause is None


@pytest.mark.parametrize("written", ["soon", "-1", "nan", "inf", ""])
def test_a_pause_that_is_none_is_refused(written: str):
    with pytest.raises(BmlError, match="pause"):
        speech("<text>x</text>", f'kinesic:pause="{written}"')


# what was recorded


def recording(description: str, source: str = "/spoken/here.bml") -> Recording | None:
    text = f'<speech id="s"><text>One <sync id="m"/>two</text>{description}</speech>'
    (behaviour,) = parse(BML.format("", text), source=source).behaviours
    assert isinstance(behaviour.action, Speech)
    assert (behaviour.action.script.text, behaviour.action.script.marks) == ("One two", (Mark("m", 4),))
    return behaviour.action.script.recording


@pytest.mark.parametrize("kind", ["audio/x-wav", "audio/wav", "AUDIO/WAV"])
@pytest.mark.parametrize(
    "inside",
    [
        ' priority="1">one.wav<',
        "> one.wav <",
        "><reference>one.wav</reference><",
        ' ref="one.wav"><',
        '><audio src="one.wav"/><',
    ],
)
def test_a_recording_is_named_in_many_ways(kind: str, inside: str):
    assert recording(f'<description type="{kind}"{inside}/description>') == Recording(
        Path("/spoken/one.wav"), folder=Path("/spoken")
    )


def test_a_recording_gives_times_to_marks():
    found = recording(
        '<description type="audio/x-wav"><audio ref="sounds/one.wav"/><sync id="m" time="0.75"/>'
        '<mark name="n" time="1"/></description>'
    )
    assert found == Recording(Path("/spoken/sounds/one.wav"), (("m", 0.75), ("n", 1.0)), Path("/spoken"))


def test_a_time_that_is_no_number_is_refused():
    with pytest.raises(BmlError, match="time='late'"):
        recording('<description type="audio/wav" ref="a.wav"><sync id="m" time="late"/></description>')


@pytest.mark.parametrize(
    "description",
    [
        '<description type="audio/wav" priority="-1" ref="a.wav"/>',
        '<description type="audio/wav"/>',
        '<description type="audio/mpeg">a.mp3</description>',
    ],
)
def test_a_description_that_is_no_recording_is_passed_over(description: str):
    assert recording(description) is None


def test_a_document_that_is_no_file_has_no_recordings():
    assert recording('<description type="audio/wav" ref="/etc/a.wav"/>', source="<text>") is None

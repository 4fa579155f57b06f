from pathlib import Path

import pytest

from kinesic.bml.block import BmlError, Speech
from kinesic.bml.parse import parse
from kinesic.body.utterance import Emphasis, Mark, Pause, Recording, Script

BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" id="b" {}>{}</bml>'


def speech(content: str, attributes: str = "") -> Speech:
    (behaviour,) = parse(BML_TEMPLATE.format("", f'<speech id="s" {attributes}>{content}</speech>')).behaviours
    assert isinstance(behaviour.action, Speech)
    return behaviour.action


def script(content: str, attributes: str = "") -> Script:
    return speech(content, attributes).script


def ssml(content: str) -> Script:
    return script(f'<text>plain</text><description type="application/ssml+xml"><speak>{content}</speak></description>')


@pytest.mark.parametrize("read", [ssml, lambda content: script(f"<text>{content}</text>")])
def test_ssml_breaks_prosody_and_emphasis_are_read_into_the_speech_script(read):
    result = read(
        'One <prosody rate="slow" pitch="+10%" volume="soft">two <emphasis level="strong">three</emphasis></prosody>'
        '<break time="400ms"/> four'
    )
    assert result.text == "One two three four"
    assert result.pauses == (Pause(13, 0.4),)
    assert result.emphases == (
        Emphasis(4, 13, "prosody", (("rate", "slow"), ("pitch", "+10%"), ("volume", "soft"))),
        Emphasis(8, 13, "emphasis", (("level", "strong"),)),
    )


@pytest.mark.parametrize(
    ("text", "seconds"),
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
def test_ssml_break_duration_is_read_from_time_or_strength(text: str, seconds: float | None):
    expected = () if seconds is None else (Pause(4, seconds),)
    assert ssml(f"One <break {text}/>two").pauses == expected


@pytest.mark.parametrize("text", ['time="soon"', 'time="-1s"', 'time="1e9s"', 'strength="huge"', 'time="100s"'])
def test_invalid_ssml_break_is_ignored_with_a_notice(text: str):
    block = parse(BML_TEMPLATE.format("", f'<speech id="s"><text>One <break {text}/>two</text></speech>'))
    (behaviour,) = block.behaviours
    assert isinstance(behaviour.action, Speech)
    assert behaviour.action.script.pauses == ()
    assert [(notice.id, "break" in notice.text) for notice in block.notices] == [("b:s", True)]


def test_speech_marks_keep_their_order_relative_to_ssml_breaks():
    result = ssml('One <mark name="a"/><break time="1s"/><mark name="b"/><break time="2s"/>two<mark name="c"/>')
    assert result.stops() == (Mark("a", 4), Pause(4, 1.0, 1), Mark("b", 4), Pause(4, 2.0, 2), Mark("c", 7))


def test_alias_of_an_ssml_sub_element_replaces_its_text():
    assert ssml('The <sub alias="World Wide Web">WWW</sub> is old').text == "The World Wide Web is old"


def test_language_changes_of_a_speech_are_read_into_the_speech_script():
    result = ssml('One <lang xml:lang="fr">bonjour</lang> <voice gender="female">two</voice> <s xml:lang="de">drei</s>')
    assert result.text == "One bonjour two drei"
    assert [(e.begin, e.end, e.attributes) for e in result.emphases] == [
        (4, 11, (("xml:lang", "fr"),)),
        (16, 20, (("xml:lang", "de"),)),
    ]


@pytest.mark.parametrize(
    ("text", "tag"), [("english", "en"), ("FRENCH", "fr"), ("pt-BR", "pt-br"), ("", "en"), ("Klingon", "klingon")]
)
def test_speech_language_is_read_from_a_name_or_a_tag(text: str, tag: str):
    assert script("<text>x</text>", f'language="{text}"').language == tag


# pauses


@pytest.mark.parametrize(
    ("text", "seconds"), [("true", 2.0), ("false", 0.0), ("0.4", 0.4), ("0", 0.0), (" TRUE ", 2.0)]
)
def test_speech_and_block_set_the_maximum_pause(text: str, seconds: float):
    assert speech("<text>x</text>", f'kinesic:pause="{text}"').pause == seconds
    block = parse(BML_TEMPLATE.format(f'kinesic:pause="{text}"', '<speech id="s"><text>x</text></speech>'))
    assert block.pause == seconds
    assert block.notices == ()
    assert speech("<text>x</text>").pause is None


@pytest.mark.parametrize("text", ["soon", "-1", "nan", "inf", ""])
def test_invalid_maximum_pause_of_a_speech_is_rejected(text: str):
    with pytest.raises(BmlError, match="pause"):
        speech("<text>x</text>", f'kinesic:pause="{text}"')


# recordings


def recording(description: str, source: str = "/spoken/here.bml") -> Recording | None:
    text = f'<speech id="s"><text>One <sync id="m"/>two</text>{description}</speech>'
    (behaviour,) = parse(BML_TEMPLATE.format("", text), source=source).behaviours
    assert isinstance(behaviour.action, Speech)
    assert (behaviour.action.script.text, behaviour.action.script.marks) == ("One two", (Mark("m", 4),))
    return behaviour.action.script.recording


@pytest.mark.parametrize("kind", ["audio/x-wav", "audio/wav", "AUDIO/WAV"])
@pytest.mark.parametrize(
    "content",
    [
        ' priority="1">one.wav<',
        "> one.wav <",
        "><reference>one.wav</reference><",
        ' ref="one.wav"><',
        '><audio src="one.wav"/><',
    ],
)
def test_file_name_of_a_speech_recording_is_read_from_each_notation_of_a_description(kind: str, content: str):
    assert recording(f'<description type="{kind}"{content}/description>') == Recording(
        Path("/spoken/one.wav"), folder=Path("/spoken")
    )


def test_sync_times_in_a_recording_description_are_read():
    result = recording(
        '<description type="audio/x-wav"><audio ref="sounds/one.wav"/><sync id="m" time="0.75"/>'
        '<mark name="n" time="1"/></description>'
    )
    assert result == Recording(Path("/spoken/sounds/one.wav"), (("m", 0.75), ("n", 1.0)), Path("/spoken"))


def test_invalid_mark_time_of_a_recording_is_rejected():
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
def test_audio_description_without_wav_file_or_with_negative_priority_is_ignored(description: str):
    assert recording(description) is None


def test_speech_recordings_are_ignored_in_documents_that_are_not_read_from_a_file():
    assert recording('<description type="audio/wav" ref="/etc/a.wav"/>', source="<text>") is None

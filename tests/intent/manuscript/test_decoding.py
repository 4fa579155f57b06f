"""Text files of any encoding, and subtitles."""

import pytest

from kinesic.intent.manuscript.decoding import decode_text, read_text_file

GREETING = "Hello, my friend! Caf\xe9."


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32"])
def test_text_with_a_byte_order_mark_is_decoded_without_a_warning(encoding: str):
    assert decode_text(GREETING.encode(encoding)) == (GREETING, ())


@pytest.mark.parametrize(
    ("content", "text", "guess"),
    [
        (GREETING.encode("cp1252"), GREETING, "cp1252"),
        ("\x81 caf\xe9".encode("latin-1"), "\x81 caf\xe9", "Latin-1"),
        (GREETING.encode("utf-16-le"), GREETING, "utf-16-le"),
        (GREETING.encode("utf-16-be"), GREETING, "utf-16-be"),
    ],
)
def test_warning_names_a_guessed_text_encoding(content: bytes, text: str, guess: str):
    decoded, warnings = decode_text(content)
    assert decoded == text
    assert len(warnings) == 1
    assert guess in warnings[0]


@pytest.mark.parametrize(
    "subtitles",
    [
        "1\r\n00:00:01,000 --> 00:00:02,000\r\n<i>Hello</i>\r\nthere.\r\n\r\n"
        "2\r\n00:00:04,500 --> 00:00:06,000\r\nBye.\r\n",
        "WEBVTT\n\nNOTE x\n\n00:01.000 --> 00:02.000 align:left\n<v Ann>Hello\nthere.\n\n"
        "id\n00:04.500 --> 00:06.000\nBye.\n",
    ],
)
def test_subtitles_are_spoken_with_their_pauses(subtitles: str):
    assert read_text_file(subtitles.encode()) == ('Hello there.\n<break time="2500ms"/>Bye.', ())

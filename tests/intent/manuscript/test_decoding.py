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


def test_subtitles_within_a_text_are_spoken_without_numbers_times_and_signs():
    text = (
        "Please read this:\n1\n00:00:01,000 --> 00:00:02,000\n- Ready?\n- Yes.\n\n"
        "2\n00:00:02,000 --> 00:00:03,000\n\u266a La la \u266a\n\nThank you."
    )
    assert read_text_file(text.encode())[0] == "Please read this:\nReady?\nYes.\nLa la\nThank you."
    assert read_text_file(b"WEBVTT\n\nNOTE by me\n\n00:01.000 --> 00:02.000\nHi.")[0] == "Hi."


def test_times_within_a_sentence_are_no_subtitles():
    text = "It goes from 00:01:00,000 to 00:02:00,000 --> then it stops."
    assert read_text_file(text.encode())[0] == text

"""Tests of text files in several encodings."""

import pytest

from kinesic.intent.manuscript.decoding import decode_text

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

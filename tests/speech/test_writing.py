"""Tests of detecting letters that espeak-ng's voices cannot read."""

import pytest

from kinesic.body.utterance import Mark, Script
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.writing import unreadable_letters


@pytest.mark.parametrize(
    ("text", "voice", "unreadable"),
    [
        ("\u79c1\u306f\u5b66\u751f\u3067\u3059\u3002\u5b66", "jpx/ja", "\u79c1\u5b66\u751f"),
        ("\u79c1\u5b66", "sit/cmn", ""),
        ("\u79c1\u5b66", "sit/yue-latn-jyutping", ""),
        ("\u30ab\u30bf", "gmw/en-US", "\u30ab\u30bf"),
        ("\uff76", "jpx/ja", ""),
        ("\u043f\u0440\u0438", "zls/bg", ""),
        ("\u043f\u0440\u0438", "roa/fr", "\u043f\u0440\u0438"),
        ("caf\u00e9 \u03a9 \uc548 \u0928 10 \u20ac!", "gmw/en-US", ""),
        ("\u16a0", "gmw/en", "\u16a0"),
        ("", "gmw/en", ""),
    ],
)
def test_letters_that_a_voice_cannot_read_are_listed(text: str, voice: str, unreadable: str) -> None:
    assert unreadable_letters(text, voice) == unreadable


@pytest.mark.skipif(bool(espeak_fault()), reason=f"espeak-ng does not work here: {espeak_fault()}")
def test_letters_that_a_voice_cannot_read_are_omitted_with_a_remark() -> None:
    kana = Espeak().say(Script(" \u306f \u3067\u3059", (), "ja"))
    mixed = Espeak().say(Script("\u79c1\u306f\u5b66\u3067\u3059", (Mark("m", 2),), "ja"))
    assert [p.symbol for p in mixed.phonemes] == [p.symbol for p in kana.phonemes]
    assert any("\u79c1\u5b66" in remark and "omitted" in remark for remark in mixed.remarks)
    assert 0.0 < mixed.marks["m"] < mixed.duration
    whole = Espeak().say(Script("\u79c1\u5b66", (), "ja"))
    assert whole.sound is None
    assert "no sound: " in whole.remarks[0]
    assert "\u79c1\u5b66" in whole.remarks[0]
    many = Espeak().say(Script("\u306f" + "".join(map(chr, range(0x4E00, 0x4E40))), (), "ja"))
    assert "and 24 other letters" in many.remarks[0]

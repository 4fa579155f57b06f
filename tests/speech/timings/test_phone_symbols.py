import pytest

from kinesic.speech.timings.phone_symbols import to_phonetic


@pytest.mark.parametrize(
    ("label", "sound"),
    [
        ("OW1", "\u02c8o\u028a"),
        ("AH0", "\u0259"),
        ("AH2", "\u02cc\u028c"),
        ("P", "p"),
        ("JH", "d\u0292"),
        ("\u0259", "\u0259"),
        ("a1", "a1"),
    ],
)
def test_arpabet_labels_become_phonetic_letters_with_stress(label: str, sound: str):
    assert to_phonetic(label) == sound

"""Conversion of phone labels of aligners into phonetic letters."""

# ruff: noqa: RUF001 - phonetic letters

from kinesic.body.utterance import STRESS_MARKS

SILENCE_LABELS = frozenset(
    {"", "sil", "sp", "spn", "<eps>", "<p:>", "<sil>", "<unk>", "_", "pau", "#"}
)  # labels of silences
_ARPABET_SOUNDS = {
    "AA": "ɑ", "AE": "æ", "AH": "ʌ", "AO": "ɔ", "AW": "aʊ", "AX": "ə", "AXR": "ɚ", "AY": "aɪ", "B": "b", "CH": "tʃ",
    "D": "d", "DH": "ð", "DX": "ɾ", "EH": "ɛ", "ER": "ɚ", "EY": "eɪ", "F": "f", "G": "ɡ", "HH": "h", "IH": "ɪ",
    "IX": "ɨ", "IY": "i", "JH": "dʒ", "K": "k", "L": "l", "M": "m", "N": "n", "NG": "ŋ", "OW": "oʊ", "OY": "ɔɪ",
    "P": "p", "R": "ɹ", "S": "s", "SH": "ʃ", "T": "t", "TH": "θ", "UH": "ʊ", "UW": "u", "UX": "ʉ", "V": "v",
    "W": "w", "Y": "j", "Z": "z", "ZH": "ʒ",
}  # fmt: skip
_STRESS_DIGITS = {"1": STRESS_MARKS[0], "2": STRESS_MARKS[1]}  # digit after an ARPABET vowel -> stress mark


def to_phonetic(label: str) -> str:
    """Return the phonetic letters of an ARPABET label such as `OW1`.

    Other labels are returned unchanged.
    """
    plain, stress = label.rstrip("012"), label[-1:]
    if plain not in _ARPABET_SOUNDS:
        return label
    sound = "ə" if label == "AH0" else _ARPABET_SOUNDS[plain]
    return _STRESS_DIGITS.get(stress, "") + sound

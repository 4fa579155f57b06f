"""Speaking rate of a word by the SSML `prosody` around it."""

import re

from kinesic.body.utterance import Script

RATE_WORDS = {
    "x-slow": 0.6, "slow": 0.8, "medium": 1.0, "default": 1.0, "fast": 1.25, "x-fast": 1.6,
}  # speech rate by word, relative to normal speech, as in espeak-ng  # fmt: skip
MIN_RATE = 0.2  # lowest speech rate of nested elements, relative to normal speech
MAX_RATE = 5.0  # highest speech rate of nested elements, relative to normal speech
_NUMBER_PATTERN = re.compile(r"([+-]?)(\d+(?:\.\d+)?)(%?)")


def rate_at(script: Script, position: int) -> float:
    """Return the speech rate at a character, relative to normal speech.

    It is the product of the rates of all `prosody` elements around the character, limited to `MIN_RATE` and `MAX_RATE`.
    """
    rate = 1.0
    for section in script.emphases:
        if section.element == "prosody" and section.begin <= position < section.end:
            rate *= read_rate(dict(section.attributes).get("rate", ""))
    return min(max(rate, MIN_RATE), MAX_RATE)


def read_rate(text: str) -> float:
    """Parse a rate such as `slow`, `80%` or `1.2`, or return 1.

    A signed number is added to 1: `+20%` is 1.2.
    """
    word = text.strip().lower()
    if word in RATE_WORDS:
        return RATE_WORDS[word]
    match = _NUMBER_PATTERN.fullmatch(word)
    if match is None:
        return 1.0
    sign, number, percent = match.groups()
    value = float(number) / (100.0 if percent else 1.0)
    return 1.0 + value * (-1.0 if sign == "-" else 1.0) if sign else value

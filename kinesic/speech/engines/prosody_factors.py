"""Rate, pitch and volume factors of SSML `prosody` and `emphasis` elements."""

import re
from collections.abc import Mapping, Sequence

from kinesic.body.utterance import Emphasis
from kinesic.speech.engines.phrase import ProsodySection
from kinesic.speech.prosody_rate import read_rate

PITCH_WORDS: Mapping[str, float] = {"x-low": 0.75, "low": 0.87, "high": 1.15, "x-high": 1.33}  # pitch factor by word
VOLUME_WORDS: Mapping[str, float] = {  # amplitude factors; 6 dB from step to step
    "silent": 0.0, "x-soft": 0.25, "soft": 0.5, "loud": 2.0, "x-loud": 4.0,
}  # fmt: skip
MAX_VOLUME = 4.0  # largest amplitude factor of a section
PITCH_LIMITS = (0.5, 2.0)  # smallest and largest pitch factor of a section
EMPHASIS_FACTORS: Mapping[str, tuple[float, float, float]] = {  # level -> factors of rate, pitch and volume
    "strong": (0.85, 1.12, 1.4),
    "moderate": (0.92, 1.06, 1.2),
    "none": (1.0, 1.0, 1.0),
    "reduced": (1.1, 0.95, 0.8),
}
_QUANTITY_PATTERN = re.compile(r"([+-]?)(\d+(?:\.\d+)?)(%|st|db|hz)?")


def convert_sections(emphases: Sequence[Emphasis]) -> tuple[ProsodySection, ...]:
    """Convert SSML `prosody` and `emphasis` elements to sections with factors."""
    sections = []
    for emphasis in emphases:
        attributes = dict(emphasis.attributes)
        if emphasis.element == "emphasis":
            factors = EMPHASIS_FACTORS.get(attributes.get("level", "moderate"), EMPHASIS_FACTORS["moderate"])
        elif emphasis.element == "prosody":
            factors = (
                read_rate(attributes.get("rate", "")),
                read_pitch(attributes.get("pitch", "")),
                read_volume(attributes.get("volume", "")),
            )
        else:
            continue
        sections.append(ProsodySection(emphasis.begin, emphasis.end, *factors))
    return tuple(sections)


def read_pitch(text: str) -> float:
    """Return the pitch factor of `high`, `+10%` or `-2st`, or 1."""
    word = text.strip().lower()
    sign, value, unit = _split(word)
    if word in PITCH_WORDS:
        factor = PITCH_WORDS[word]
    elif unit == "st":
        factor = 2.0 ** (_signed(sign, value) / 12.0)
    elif unit == "%":
        factor = 1.0 + _signed(sign, value) / 100.0 if sign else value / 100.0
    else:  # an absolute pitch [Hz] depends on the voice
        factor = 1.0
    return min(max(factor, PITCH_LIMITS[0]), PITCH_LIMITS[1])


def read_volume(text: str) -> float:
    """Return the amplitude factor of `soft`, `+6dB` or `50`, or 1."""
    word = text.strip().lower()
    sign, value, unit = _split(word)
    if word in VOLUME_WORDS:
        factor = VOLUME_WORDS[word]
    elif unit == "db":
        factor = 10.0 ** (_signed(sign, value) / 20.0)
    elif unit in ("", "%") and value >= 0.0:
        factor = 1.0 + _signed(sign, value) / 100.0 if sign else value / 100.0
    else:
        factor = 1.0
    return min(max(factor, 0.0), MAX_VOLUME)


def _split(word: str) -> tuple[str, float, str]:
    """Return sign, number (-1 if missing) and unit of a quantity."""
    match = _QUANTITY_PATTERN.fullmatch(word)
    return (match[1], float(match[2]), match[3] or "") if match else ("", -1.0, "none")


def _signed(sign: str, value: float) -> float:
    return -value if sign == "-" else value

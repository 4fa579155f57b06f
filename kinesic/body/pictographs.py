"""Patterns that find emoji and other pictographs in text."""

import re

PICTOGRAPH_RANGES = (  # Unicode blocks of pictographs, to put inside [...] of a regular expression
    "\u231a-\u23ff\u25a0-\u27bf\u2b00-\u2bff\u3030\u303d\u3297\u3299\U0001f000-\U0001faff"
)
JOINER_RANGES = "\u200d\u20e3\ufe0e\ufe0f\U0001f3fb-\U0001f3ff\U000e0020-\U000e007f"  # joiners, skin tones and tags
# a pictograph with its joiners, a keycap such as 1\ufe0f\u20e3, or joiners alone
PICTOGRAPH_PATTERN = re.compile(f"[0-9#*]\ufe0f?\u20e3|[{PICTOGRAPH_RANGES}][{JOINER_RANGES}]*|[{JOINER_RANGES}]+")
_SINGLE_PICTOGRAPH = re.compile(f"[{PICTOGRAPH_RANGES}]")  # one pictographic character, without joiners


def is_pictograph(character: str) -> bool:
    """Return whether a single character by itself is a pictograph."""
    return bool(_SINGLE_PICTOGRAPH.match(character))


def blank_pictographs(text: str) -> str:
    """Replace every pictograph by as many spaces as it has characters."""
    return PICTOGRAPH_PATTERN.sub(lambda found: " " * len(found[0]), text)

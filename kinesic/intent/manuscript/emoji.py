"""Emoji, short codes (`:smile:`), keycap emoji and terminal escape sequences of texts."""

import re
import unicodedata

from kinesic.body.pictographs import JOINER_RANGES, PICTOGRAPH_RANGES
from kinesic.intent.manuscript.acts import load_acts
from kinesic.intent.manuscript.pieces import Step, direct

_SHORT_CODE = re.compile(r":([a-z][a-z_]{2,28}|[+-]1)(?::t[1-6]|::skin-tone-[1-6])?:(?!\w)")  # name, optional skin tone
_OPEN_SHORT_CODE = re.compile(r":(?:[a-z_]{0,29}|[+-]1?):?(?:(?<=:)(?:t[1-6]?|:[a-z0-9-]{0,11}):?)?")
_TERMINAL_COMMAND = re.compile(r"\x1b(?:\[[0-9;?]*[A-Za-z]?)?")  # colour or position in a terminal
_OPEN_COMMAND = re.compile(r"\x1b(?:\[[0-9;?]{0,20})?")
_KEYCAP_PATTERN = re.compile("[0-9]\ufe0f?\u20e3")  # keycap emoji of a digit
_OPEN_KEYCAP = re.compile("[0-9]\ufe0f?")
_JOINABLE_RANGES = JOINER_RANGES.replace("\u200d", "")
_EMOJI_PATTERN = re.compile(
    f"[\U0001f1e6-\U0001f1ff]{{1,2}}|[{PICTOGRAPH_RANGES}][{_JOINABLE_RANGES}]*(?:\u200d[{PICTOGRAPH_RANGES}]?[{_JOINABLE_RANGES}]*)*"
)


def read_short_code(rest: str, *, ends: bool) -> Step | None:
    """Convert an emoji short code such as `:smile:` to a stage direction."""
    if not ends and _OPEN_SHORT_CODE.fullmatch(rest):
        return None
    match = _SHORT_CODE.match(rest)
    if match is None:
        return Step(1, ":")
    name = match[1].replace("_", " ").replace("+1", "thumbs up").replace("-1", "thumb down")
    return Step(match.end(), direct(name))


def read_emoji(rest: str, *, ends: bool) -> Step | None:
    """Read an emoji with its joiners and skin tone."""
    match = _EMOJI_PATTERN.match(rest)
    assert match is not None  # the first character is a pictograph
    if not ends and match.end() == len(rest):
        return None  # a joiner or a skin tone may follow
    first = match[0][0]
    if "\U0001f1e6" <= first <= "\U0001f1ff":
        return Step(match.end(), " ", "emoji is not shown: flag")
    return perform_emoji(first, match.end())


def perform_emoji(emoji: str, length: int) -> Step:
    """Convert an emoji to a feeling, a stage direction or a warning.

    Args:
        emoji: without joiners and skin tone.
        length: number of characters of the text that it stands for.
    """
    if load_acts().has("feelings", emoji):
        return Step(length, emoji)
    if load_acts().find(emoji):
        return Step(length, direct(emoji))
    return Step(length, " ", f"emoji is not shown: {unicodedata.name(emoji, emoji).lower()}")


def read_control(rest: str, *, ends: bool) -> Step | None:
    """Skip a terminal escape sequence or a keycap emoji.

    Returns:
        Length 0 for a digit without a keycap.
    """
    pattern, opening = (_KEYCAP_PATTERN, _OPEN_KEYCAP) if rest[0].isdigit() else (_TERMINAL_COMMAND, _OPEN_COMMAND)
    if not ends and opening.fullmatch(rest):
        return None
    match = pattern.match(rest)
    return Step(match.end(), " " if rest[0].isdigit() else "") if match else Step(0)

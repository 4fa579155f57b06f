"""Safe file names for all operating systems, made from untrusted text."""

import re

MAX_STEM_LENGTH = 64  # [characters] longest file name before its suffix
PORT_DIGITS = "0123456789\N{SUPERSCRIPT ONE}\N{SUPERSCRIPT TWO}\N{SUPERSCRIPT THREE}"  # digits of Windows port names
# File names that Windows reserves for devices with any suffix, in lower case.
DEVICE_NAMES = frozenset(
    {
        *("con", "prn", "aux", "nul", "conin$", "conout$", "clock$"),
        *(f"{port}{digit}" for port in ("com", "lpt") for digit in PORT_DIGITS),
    }
)
_UNSAFE_CHARACTERS = re.compile(r"[^A-Za-z0-9_-]+")  # characters that `plain_stem` replaces


def cut_name(name: str, *, limit: int) -> str:
    """Return a name's longest prefix of at most `limit` UTF-8 bytes."""
    return name.encode("utf-8", "ignore")[:limit].decode("utf-8", "ignore")


def is_device_name(name: str) -> bool:
    """Return whether Windows reserves a file name for a device."""
    return name.partition(".")[0].rstrip(" ").lower() in DEVICE_NAMES


def plain_stem(text: str, *, fallback: str) -> str:
    """Return a safe file name, without suffix, that resembles a text.

    Args:
        text: foreign text, such as the id of a block.
        fallback: name for a text without ASCII letters and digits.

    Returns:
        1 to 64 letters, digits, hyphens and underscores, the first of them a letter or digit.
    """
    stem = (
        _UNSAFE_CHARACTERS.sub("_", text[: 4 * MAX_STEM_LENGTH]).lstrip("_-")[:MAX_STEM_LENGTH].rstrip("_-") or fallback
    )
    return f"{stem}_" if is_device_name(stem) else stem

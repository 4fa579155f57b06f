"""Words of strangers, for a terminal; quick to import."""


def printable(words: str) -> str:
    """Spells out characters that a terminal would obey, such as the beginning of an escape sequence."""
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in words)

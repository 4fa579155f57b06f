"""Words of strangers, for a terminal; quick to import."""


def printable(words: str) -> str:
    """Spells out characters that a terminal would obey, such as the beginning of an escape sequence."""
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in words)


def printable_xml(text: str) -> str:
    """Writes characters that a terminal would obey as XML's references to them: it is read as the same document."""
    return "".join(each if each.isprintable() or each in "\n\t" else f"&#{ord(each)};" for each in text)

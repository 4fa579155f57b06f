"""Escaping of untrusted text for the terminal.

The module is quick to import.
"""


def printable(text: str) -> str:
    """Escape control characters, such as the start of a terminal escape sequence."""
    return "".join(character if character.isprintable() else repr(character)[1:-1] for character in text)


def printable_xml(text: str) -> str:
    """Replace control characters with XML character references.

    The result parses as the same document.
    """
    return "".join(
        character if character.isprintable() or character in "\n\t" else f"&#{ord(character)};" for character in text
    )

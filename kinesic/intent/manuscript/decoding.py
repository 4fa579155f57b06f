"""Decoding of text files in several encodings."""

import codecs

NUL_FRACTION = 0.2  # fraction of zero bytes above which a text without byte order mark is UTF-16
_BYTE_ORDER_MARKS = (  # byte order marks; UTF-32 first, because its mark begins with that of UTF-16
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


def decode_text(content: bytes) -> tuple[str, tuple[str, ...]]:
    """Decode a text file.

    Returns:
        Text, and a warning if its encoding is only a guess.
    """
    for mark, encoding in _BYTE_ORDER_MARKS:
        if content.startswith(mark):
            return content.decode(encoding, "replace"), ()
    if content.count(0) > NUL_FRACTION * len(content):
        encoding = "utf-16-le" if content[1::2].count(0) > content[::2].count(0) else "utf-16-be"
        return content.decode(encoding, "replace"), (f"the text has no byte order mark: it is read as {encoding}",)
    try:
        return content.decode("utf-8"), ()
    except UnicodeDecodeError as error:
        where = f"byte {error.start} is not UTF-8"
    try:
        return content.decode("cp1252"), (f"{where}: the text is read as cp1252 (Windows, Western Europe)",)
    except UnicodeDecodeError:
        return content.decode("latin-1"), (f"{where}: the text is read as Latin-1",)

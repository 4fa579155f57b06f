"""Text with lone surrogates, which UTF-8 cannot encode.

Python reads a file name that is not UTF-8 as text with lone surrogates, and JSON can contain them as escapes.
"""

from kinesic.body.config import ConfigError


def check_encodable(text: str, *, place: str) -> None:
    """Refuse a text that UTF-8 cannot encode.

    Args:
        text: text that is to be written as UTF-8.
        place: name of the file or value that contains the text; begins the message.

    Raises:
        ConfigError: the text contains a lone surrogate.
    """
    try:
        text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise ConfigError(f"{place}: character {error.start} is not a Unicode character; remove it") from None


def escape_surrogates(text: str) -> str:
    r"""Return a text with lone surrogates written as escapes such as `\udcff`."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")

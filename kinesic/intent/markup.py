"""Text and attributes as they stand in XML."""


def escape(text: str) -> str:
    """Writes text so that nothing in it is markup."""
    from xml.sax import saxutils  # noqa: PLC0415 - brings clients of the web with it, and few documents are written

    return saxutils.escape(text)


def quote(value: str) -> str:
    """Writes the value of an attribute, with its quotation marks."""
    from xml.sax import saxutils  # noqa: PLC0415 - as above

    return saxutils.quoteattr(value)

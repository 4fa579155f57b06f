"""Escaping of XML text and attributes."""


def escape(text: str) -> str:
    """Escape a text for XML."""
    from xml.sax import saxutils  # noqa: PLC0415 - imports web clients, and few documents are written

    return saxutils.escape(text)


def quote(value: str) -> str:
    """Quote an attribute value for XML."""
    from xml.sax import saxutils  # noqa: PLC0415 - as above

    return saxutils.quoteattr(value)

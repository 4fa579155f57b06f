"""Search for a document's first tag after a long XML prologue."""

import re

_PROLOGUE_DELIMITERS = {
    "<?": "?>",
    "<!--": "-->",
    "<!DOCTYPE": ">",
}  # start -> end of XML markup before the root element
_PROLOGUE_PATTERN = re.compile(r"\s*(<\?|<!--|<!DOCTYPE|)", re.IGNORECASE)  # start of markup before the root element
_TAG_PATTERN = re.compile(r"<(?:[\w.-]+:)?([\w.-]+)[\s/>]")  # start tag


def find_first_tag(text: str) -> str:
    """Return the local name of a document's first tag in lower case.

    A declaration, processing instructions, comments and a document type may precede the tag. The result is empty if
    other text comes first.

    Args:
        text: the document or its beginning.
    """
    at = 0
    while (opening := _PROLOGUE_PATTERN.match(text, at)) and opening[1]:
        end = _PROLOGUE_DELIMITERS[opening[1].upper()]
        at = text.find(end, opening.end()) + len(end)
        if at < len(end):
            return ""  # unterminated
    tag = _TAG_PATTERN.match(text, opening.end() if opening else at)
    return tag[1].lower() if tag else ""

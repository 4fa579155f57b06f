"""The first tag of a document, found in one pass: what goes before it may be anybody's, and as long as he likes."""

import re

_SKIPPED = {"<?": "?>", "<!--": "-->", "<!DOCTYPE": ">"}  # what may go before a root: how it begins and ends
_OPENING = re.compile(r"\s*(<\?|<!--|<!DOCTYPE|)", re.IGNORECASE)
_TAG = re.compile(r"<(?:[\w.-]+:)?([\w.-]+)[\s/>]")


def first_tag(text: str) -> str:
    """Finds the local name of a document's first tag, in small letters; empty where it begins with anything else.

    A declaration, instructions, comments and a document type may go before it.

    Args:
        text: of the document, or its beginning.
    """
    at = 0
    while (opening := _OPENING.match(text, at)) and opening[1]:
        end = _SKIPPED[opening[1].upper()]
        at = text.find(end, opening.end()) + len(end)
        if at < len(end):
            return ""  # it never ends
    found = _TAG.match(text, opening.end() if opening else at)
    return found[1].lower() if found else ""

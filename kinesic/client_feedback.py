"""Ids of documents, and refusals of blocks in feedback, for the client."""

import json
import re
from html import unescape
from xml.parsers import expat

_UNNAMED_BLOCK = "block"  # id that the server assigns to a block without one
_ID_SEARCH_LENGTH = 65_536  # [characters] length of a broken document searched for its id, as on the server
# Comments and CDATA sections, closed or not, so that the search takes linear time; or the id of a <bml>.
_BROKEN_ID_PATTERN = re.compile(
    r"""<!--(?:.*?-->|.*)|<!\[CDATA\[(?:.*?\]\]>|.*)|<(?:\w+:)?bml\b[^<>]*?\sid\s*=\s*(?:"([^"]+)"|'([^']+)')""",
    re.DOTALL | re.ASCII,
)


def document_id(bml: str) -> str:
    """Return the id of a document's block, or `block` without one."""
    if bml.lstrip().startswith("{"):
        try:
            return str(json.loads(bml).get("id", _UNNAMED_BLOCK))
        except ValueError:
            return _UNNAMED_BLOCK
    try:
        return _xml_id(bml)
    except expat.ExpatError:
        ids = (match[1] or match[2] for match in _BROKEN_ID_PATTERN.finditer(bml, 0, _ID_SEARCH_LENGTH))
        return unescape(next(filter(None, ids), "")).strip() or _UNNAMED_BLOCK


class _BlockFound(Exception):  # noqa: N818 - ends the parser, not an error
    """Exception that ends parsing and carries the first <bml>'s id."""


def _xml_id(bml: str) -> str:
    """Return the id of an XML document's first <bml>, or `block`.

    Raises:
        ExpatError: the document is broken before its <bml>.
    """

    def begin(name: str, attributes: dict[str, str]) -> None:
        if name.rpartition(":")[2] == "bml":
            raise _BlockFound(attributes.get("id", ""))

    parser = expat.ParserCreate()  # it respects the declared encoding, like the server
    parser.StartElementHandler = begin
    try:
        parser.Parse(bml.encode(errors="replace"), True)
    except _BlockFound as block_found:
        return str(block_found).strip() or _UNNAMED_BLOCK
    return _UNNAMED_BLOCK


def refuses_block(message: str, name: str) -> bool:
    """Return whether a message refuses a block."""
    head, _, text = message.partition(">")
    nothing = "PARSING_FAILURE" in head or text.startswith(("rule ", "not performed"))
    return head.startswith("<warningFeedback") and f' id="{name}"' in head and nothing

"""Extraction of documents from Markdown fences or prose of language models.

Blanks replace the text around a document, so that all lines and columns stay.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from kinesic.bml.reading.prologue import find_first_tag

ROOT_NAMES = ("bml", "fml-apml", "speak")  # root elements of documents
MAX_OPENED_SIZE = 8_000_000  # [bytes or characters] longest text in which a document is searched for
MAX_SHOWN_LENGTH = 60  # [characters] longest quotation of ignored text in a notice
_BLANK_CHARACTERS = " \t\r\n\ufeff"
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")  # byte order marks of UTF-16
_ROOT_TAG = re.compile(r"<(?P<name>(?:[\w.-]+:)?(?:bml|fml-apml|speak))(?=[\s/>])[^<>]*>", re.IGNORECASE)
# reasoning of a language model before its answer
_THOUGHT_ELEMENT = re.compile(r"\s*<(think|thinking|thought|thoughts|reasoning|reflection)>.*?</\1>", re.DOTALL)
_MARKDOWN_FENCE = re.compile(
    r"^[ \t]*(`{3,}|~{3,})[^\n`]*\n(.*?)(?:^[ \t]*\1[`~]*[ \t]*\r?$|\Z)", re.DOTALL | re.MULTILINE
)
_XML_DECLARATION = re.compile(r"\s*<\?xml[^<>]*\?>", re.IGNORECASE)  # XML declaration
_JSON_START = re.compile(r"\{\s*\"|\[\s*\{\s*\"")  # start of a JSON object, or of a list of objects
# key that only a BML document in JSON has
_JSON_DOCUMENT = re.compile(r"\"(?:type|behaviours|behaviors|data|bml)\"\s*:")
_JSON_TOKEN = re.compile(r"\"(?:[^\"\\\n]|\\.)*+\"?|[{}\[\]]")  # an unclosed string ends with its line
_BLANK_RUN = re.compile(r"[\s\ufeff]*")  # any number of blanks


@dataclass(frozen=True)
class OpenedDocument:
    """Document extracted from the answer of a language model."""

    text: str | bytes  # document, with blanks in place of the text around it
    surroundings: tuple[str, ...] = ()  # ignored parts, for notices; empty if the text is the document


def open_document(text: str | bytes) -> OpenedDocument:
    """Find the document in the answer of a language model.

    A Markdown fence, thoughts and prose may surround it. Other text is returned unchanged, and so is text that is too
    large, which the parser refuses quickly.

    Args:
        text: the document or a text that contains it; bytes are UTF-8, or UTF-16 with a byte order mark.
    """
    plain = _decode(text) if len(text) <= MAX_OPENED_SIZE else None
    if plain is None:
        return OpenedDocument(text)
    span = _find_document(plain)
    if span is None:
        return OpenedDocument(text)
    begin, end = span
    before, after = plain[:begin], plain[end:]
    if not before.strip(_BLANK_CHARACTERS) and not after.strip(_BLANK_CHARACTERS):
        return OpenedDocument(text)
    declaration = _XML_DECLARATION.match(plain, begin, end)
    if declaration and before:
        begin = declaration.end()
    return OpenedDocument(_blank(plain[:begin]) + plain[begin:end] + _blank(after), tuple(_describe(before, after)))


def find_root(text: str | bytes) -> str:
    """Return the local name of the root element in lower case.

    Text around the document does not matter. The result is empty for JSON and other text.
    """
    plain = _decode(text)
    if plain is None:
        return ""
    name = find_first_tag(plain.lstrip(_BLANK_CHARACTERS))
    if name in ROOT_NAMES or plain.lstrip(_BLANK_CHARACTERS)[:1] == "{":
        return name
    span = _find_document(plain)
    return find_first_tag(plain[span[0] : span[1]]) if span else name


def is_wrapped(text: str | bytes) -> bool:
    """Return whether a fence or prose surrounds a document in a text."""
    return bool(open_document(text).surroundings)


def _decode(text: str | bytes) -> str | None:
    if isinstance(text, str):
        return text
    try:
        return text.decode("utf-16" if text.startswith(_UTF16_MARKS) else "utf-8-sig")
    except UnicodeDecodeError:
        return None


def _find_document(text: str) -> tuple[int, int] | None:
    """Return begin and end of the document in a text, or None."""
    thought = _THOUGHT_ELEMENT.match(text)
    start = text[thought.end() if thought else 0 :].lstrip(_BLANK_CHARACTERS)
    begin = len(text) - len(start)
    if start[:1] == "{" or _JSON_START.match(start):
        return begin, _json_end(text, begin)
    if start.startswith("<") and not start.startswith("<|"):
        name = find_first_tag(start)
        if name in ROOT_NAMES:
            return begin, _xml_end(text, begin)
        if not _starts_with_unknown_element(start):
            return None
    for fence in _MARKDOWN_FENCE.finditer(text, begin):
        inside = fence[2].lstrip(_BLANK_CHARACTERS)
        if inside[:1] in ("{", "[") or find_first_tag(inside):
            first = fence.start(2) + len(fence[2]) - len(inside)
            return first, first + len(inside.rstrip())
    return _find_in_prose(text, begin)


def _starts_with_unknown_element(text: str) -> bool:
    """Return whether the text starts with an unknown element around the document."""
    inside = re.match(r"<[\w-]+>\s*(?:[{\[]|`{3}|<\?xml)", text)
    return inside is not None


def _find_in_prose(text: str, begin: int) -> tuple[int, int] | None:
    root = _ROOT_TAG.search(text, begin)
    match = _find_json(text, begin)
    if root and (match is None or root.start() < match[0]):
        return root.start(), _xml_end(text, root.start(), is_in_prose=True)
    return match


def _find_json(text: str, begin: int) -> tuple[int, int] | None:
    while start := _JSON_START.search(text, begin):
        end = _json_end(text, start.start())
        if _JSON_DOCUMENT.search(text, start.start(), end):
            return start.start(), end
        begin = end
    return None


def _json_end(text: str, begin: int) -> int:
    """Return the end of the JSON value that begins at an index.

    The end of the text if brackets are missing or another value follows, so that the reader of JSON reports it.
    """
    depth = 0
    for token in _JSON_TOKEN.finditer(text, begin):
        depth += (token[0] in "{[") - (token[0] in "}]")
        if depth == 0:
            following = _BLANK_RUN.match(text, token.end())
            after = following.end() if following else token.end()
            return len(text) if text[after : after + 1] in ("{", "[", ",", '"') else token.end()
    return len(text)


def _xml_end(text: str, begin: int, *, is_in_prose: bool = False) -> int:
    """Return the end of the XML document that begins at an index.

    The end of the text if markup follows the root, so that the reader of XML reports it. End tags may follow in prose.
    """
    root = _ROOT_TAG.search(text, begin)
    if root is None:
        return len(text)
    closing = list(re.finditer(rf"</{re.escape(root['name'])}\s*>", text[root.end() :]))
    if root[0].endswith("/>"):
        end = root.end()
    elif closing:
        end = root.end() + closing[-1].end()
    else:
        return len(text)
    markup = r"<|-->" if not is_in_prose else r"<[^/]|-->"  # that is no prose
    return len(text) if re.search(markup, text[end:]) else end


def _blank(text: str) -> str:
    return re.sub(r"[^\r\n]", " ", text)


def _describe(before: str, after: str) -> Iterator[str]:
    """Yield notices about the ignored fences and text around a document."""
    thought = _THOUGHT_ELEMENT.match(before)
    if thought:
        yield "thoughts before the document are ignored"
        before = before[thought.end() :]
    prose = {name: _prose(part) for name, part in (("before", before), ("after", after))}
    if "```" in before + after or "~~~" in before + after:
        yield "the Markdown fence around the document is ignored"
    for name, words in prose.items():
        if words:
            shown = words if len(words) <= MAX_SHOWN_LENGTH else f"{words[:MAX_SHOWN_LENGTH]}..."
            yield f"text {name} the document is ignored: {shown}"


def _prose(part: str) -> str:
    """Return the text before or after a document, without code fences."""
    words = " ".join(_XML_DECLARATION.sub("", part.replace("\ufeff", "")).split())
    return re.sub(r"[`~]{3,} ?\w*$|[`~]{3,}", "", words).strip()

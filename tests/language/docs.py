"""Sentences of Markdown pages, without code, tables and headings."""

import re
from collections.abc import Iterator
from pathlib import Path

from .code import Finding
from .rules import MAX_SENTENCE_WORDS

SKIPPED_STARTS = ("|", "#", "<", "![")  # tables, headings, HTML and pictures
LIST_ITEM = re.compile(r"\s*([-*]|\d+\.)\s+")
SENTENCE_END = re.compile(r"(?<=[\w)`\"*%\]][.!?])\s+|(?<=:)\s+(?=[A-Z])")


def read_sentences(page: Path, name: str) -> Iterator[Finding]:
    """Yield every sentence of a page; one above the limit is an offender."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for paragraph in _paragraphs(text):
        for sentence in SENTENCE_END.split(re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", paragraph)):
            words = len(sentence.split())
            if words:
                yield Finding("long sentences", name, sentence, words > MAX_SENTENCE_WORDS)


def _paragraphs(text: str) -> Iterator[str]:
    """Yield paragraphs and list items, each joined to one line."""
    for block in re.split(r"\n\s*\n", text):
        lines: list[str] = []
        for line in block.splitlines():
            if line.lstrip().startswith(SKIPPED_STARTS):
                continue
            if LIST_ITEM.match(line):
                yield " ".join(lines)
                lines = []
            lines.append(LIST_ITEM.sub("", line, count=1).strip())
        yield " ".join(lines)

"""Troubleshooting page: every message that it explains exists in the code."""

import re
from functools import cache
from pathlib import Path

from .naming import about

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "troubleshooting.md"
LETTERS = re.compile(r"[a-z]{3}")


def messages() -> list[str]:
    """Return all messages in the first columns of the tables, without those of reports."""
    text = PAGE.read_text(encoding="utf-8").partition("\n## Reports\n")[0]
    cells = re.findall(r"^\| (`.+?`) \| ", text, re.MULTILINE)
    return [message for cell in cells for message in re.findall(r"`([^`]+)`", cell)]


@cache
def texts_of_code() -> str:
    """Return the sources of the package, with adjacent string literals joined."""
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "kinesic").rglob("*.py")]
    return re.sub(r'"\s*\n\s*f?"', "", "\n".join(sources))


def test_troubleshooting_page_explains_more_than_50_messages():
    assert len(messages()) > 50


def test_error_messages_quoted_on_the_troubleshooting_page_exist_in_the_code():
    for message in messages():
        parts = [part.strip(" '") for part in message.split("...")]
        words = [part for part in parts if LETTERS.search(part)]
        missing = [part for part in words if part not in texts_of_code()]
        with about(message):
            assert words
            assert missing == [], "the code has other words now: edit docs/troubleshooting.md"

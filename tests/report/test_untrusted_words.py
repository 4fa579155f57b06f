"""Literal display of hostile texts on the report's page."""

from html import escape
from html.parser import HTMLParser
from pathlib import Path

import pytest

from kinesic.controller.dry_run import dry_run
from kinesic.planning.setup import Setup
from kinesic.report.page import write_page
from kinesic.report.report import report
from kinesic.session.plan import plan

from ..chromium import binary, opened

HOSTILE_TEXT = (
    "<script>window.hacked=1</script>",
    "</script><script>window.hacked=2</script>",
    '"><img src=x: onerror="window.hacked=3">',
    "' onclick='window.hacked=4' javascript:window.hacked=5",
    "</style></title></pre><svg onload=window.hacked=6>",
    "{{ 7 * 7 }} {% raw %} $x^{$ [/bold] <!-- ]]>",
)


def document(words: tuple[str, ...]) -> str:
    """Return a block in which every name and every text is hostile."""
    one, two, three, four, five, six = (escape(word, quote=True) for word in words)
    return (
        f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{one}">'
        f'<head id="{two}" lexeme="NOD" start="0.2"/><gesture id="{three}" lexeme="{four}" start="1"/>'
        f'<gesture id="{four}" lexeme="BEAT" stroke="1.5"/><gesture id="{five}" lexeme="BEAT" stroke="0.05"/>'
        f'<speech id="{six}" start="0"><text>{one} {two} <sync id="{five}"/> {three} {six}</text></speech></bml>'
    )


def written(words: tuple[str, ...], known: Setup, path: Path) -> Path:
    done = dry_run(plan(document(words), known, source=words[0]))
    write_page(done, report(done, source=words[2]), path=path)
    return path


@pytest.fixture(scope="module")
def page(known: Setup, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(HOSTILE_TEXT, known, tmp_path_factory.mktemp("evil") / "report.html")


class Elements(HTMLParser):
    """Elements of a page with their attributes."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))


def test_untrusted_words_create_no_html_element_event_handler_or_link(page: Path):
    result = Elements(page).found
    assert sum(tag == "script" for tag, _ in result) == 2
    assert not [tag for tag, _ in result if tag in ("iframe", "object", "embed", "base", "link", "form")]
    assert not [attributes for _, attributes in result if any(name.startswith("on") for name in attributes)]
    for _, attributes in result:
        for name in ("href", "src", "xlink:href"):
            assert (attributes.get(name) or "#").startswith(("#", "data:"))
    assert "{{ 7 * 7 }}" in page.read_text(encoding="utf-8")


@pytest.mark.realtime
@pytest.mark.skipif(binary() is None, reason="no Chromium: apt-get install chromium")
def test_browser_ignores_untrusted_markup_and_plays_the_replay(page: Path, tmp_path: Path):
    with opened(page.as_uri(), drawn=False) as tab:
        tab.until("document.querySelector('#stage')?.hidden === false")
        assert tab.value("window.hacked ?? 0") == 0
        assert HOSTILE_TEXT[0] in tab.value("document.body.innerText")
        tab.value("document.body.insertAdjacentHTML('beforeend', '<img src=x: onerror=\"window.hacked=7\">')")
        tab.until("document.querySelector('img[onerror]').complete")
        assert tab.value("window.hacked ?? 0") == 0  # were markup to slip through, the page's policy stops its scripts

from pathlib import Path

import pytest

from kinesic.cli import browser, demo
from kinesic.session.builtin_documents import builtin_documents

NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'


@pytest.fixture
def opened(monkeypatch) -> list[str]:
    """List the pages that a simulated browser opens."""
    pages: list[str] = []
    monkeypatch.setattr(browser, "has_display", lambda: True)
    monkeypatch.setattr(browser.webbrowser, "open", lambda url: bool(pages.append(url)) or True)
    return pages


@pytest.fixture
def short(tmp_path, monkeypatch) -> None:
    """Replace the demo's document by a short nod."""
    nod = tmp_path / "elsewhere" / "nod.bml"
    nod.parent.mkdir()
    nod.write_bytes(NOD)
    monkeypatch.setattr(demo, "DEMO_DOCUMENT", str(nod))


def test_demo_writes_a_report_opens_it_and_replaces_an_earlier_one(kinesic, tmp_path, opened, short):
    for _ in range(2):
        ended = kinesic("demo", "--no-film", "--robot", "upper22")
        assert ended.code == 0, ended.err
    page = tmp_path / "out" / "demo" / "report.html"
    assert opened == [page.resolve().as_uri()] * 2
    assert f"page: {Path('out/demo/report.html')}\nthe page is open in the browser\n" in ended.out


def test_demo_with_no_open_opens_no_browser_and_never_replaces_user_folders(kinesic, tmp_path, opened, short):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    options = ("demo", "--no-film", "--robot", "upper22", "--no-open", "--out")
    refused = kinesic(*options, "mine", "--force")
    assert refused.code == 2
    assert [file.name for file in (tmp_path / "mine").iterdir()] == ["letter.txt"]
    assert kinesic(*options, "other").code == 0
    assert kinesic(*options, "other").code == 2  # A folder of the user's is replaced by --force alone.
    assert opened == []


def test_demo_uses_a_builtin_document_and_the_robot_upper36_by_default(kinesic):
    assert demo.DEMO_DOCUMENT in builtin_documents()
    assert "upper36" in kinesic("demo", "-h").out


def test_browser_is_opened_only_with_a_display(monkeypatch, opened):
    assert browser.open_in_browser("http://localhost/")
    monkeypatch.setattr(browser, "has_display", lambda: False)
    assert not browser.open_in_browser("http://localhost/")
    assert opened == ["http://localhost/"]

"""Builder of the documentation site: navigation, links, lists and versions."""

import json
import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="module")
def site() -> dict:
    """Functions of docs/make/site.py."""
    return runpy.run_path(str(ROOT / "docs" / "make" / "site.py"), run_name="site")


def test_site_navigation_is_read_as_pages_with_their_sections(site):
    text = "site_name: a\n\nnav:\n  - Home: index.md\n  - Guides:\n    - guides/index.md\n    - One: guides/one.md\n"
    entries = [(entry.section, entry.page) for entry in site["read_navigation"](text)]
    assert entries == [("Home", "index.md"), ("Guides", "guides/index.md"), ("Guides", "guides/one.md")]


def test_link_check_finds_missing_pages_pictures_and_anchors(site, tmp_path: Path):
    (tmp_path / "a").mkdir()
    (tmp_path / "index.html").write_text(
        '<h1 id="top">x</h1><a href="a/">1</a><a href="a/#here">2</a><a href="#top">3</a>'
        '<a href="https://example.org/none">4</a><a href="b/">5</a><a href="a/#gone">6</a><img src="a/none.png">'
        '<link rel="stylesheet" href="https://fonts.example/x.css"><link rel="canonical" href="https://example.org/">',
        encoding="utf-8",
    )
    (tmp_path / "a" / "index.html").write_text(
        '<p id="here"><a href="../#lost">7</a><a href="..">8</a>', encoding="utf-8"
    )
    assert list(site["find_broken_links"](tmp_path)) == [
        "a/index.html: ../#lost",
        "index.html: https://fonts.example/x.css",
        "index.html: b/",
        "index.html: a/#gone",
        "index.html: a/none.png",
    ]


def test_page_lists_for_language_models_contain_each_page_with_its_first_sentence(site, tmp_path: Path):
    entries = site["read_navigation"]((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    for entry in entries:
        (tmp_path / entry.page).parent.mkdir(parents=True, exist_ok=True)
    site["write_llms_files"](tmp_path, entries)
    listed = re.findall(r"^- \[[^]]+\]\(([^)]+)\): (.+)$", (tmp_path / "llms.txt").read_text(encoding="utf-8"), re.M)
    assert [page for page, _ in listed] == [entry.page for entry in entries]
    assert all(sentence.endswith((".", ":")) for _, sentence in listed)
    assert (tmp_path / "reference" / "bml.md").read_text(encoding="utf-8").startswith("# BML")
    assert "<!-- reference/bml.md -->" in (tmp_path / "llms-full.txt").read_text(encoding="utf-8")


def test_published_versions_of_the_site_are_listed_newest_first(site, tmp_path: Path):
    built = tmp_path / "built"
    built.mkdir()
    for version in ("0.1.0", "0.2.0", "0.2.0"):
        (built / "index.html").write_text(version, encoding="utf-8")
        site["publish"](built, tmp_path / "all", version)
    versions = json.loads((tmp_path / "all" / "versions.json").read_text(encoding="utf-8"))
    assert [(entry["version"], entry["aliases"]) for entry in versions] == [("0.2.0", ["latest"]), ("0.1.0", [])]
    assert (tmp_path / "all" / "0.1.0" / "index.html").read_text(encoding="utf-8") == "0.1.0"
    assert (tmp_path / "all" / "latest" / "index.html").read_text(encoding="utf-8") == "0.2.0"
    assert "latest/" in (tmp_path / "all" / "index.html").read_text(encoding="utf-8")

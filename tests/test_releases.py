"""Releases: one page each, with breaking changes first, and one version everywhere."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RELEASES = ROOT / "docs" / "releases"
MAX_UNRELEASED_LINES = 170  # lines of CHANGELOG.md that a reader finds before the next release moves them to its page


def version() -> str:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]


def test_citation_has_the_version_of_the_package():
    assert f"\nversion: {version()}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_release_index_begins_with_the_current_version():
    listed = re.findall(r"^\| \[([\d.]+)\]\(\1\.md\) \|", (RELEASES / "index.md").read_text(encoding="utf-8"), re.M)
    assert listed[0] == version()
    assert listed == sorted((page.stem for page in RELEASES.glob("[0-9]*.[0-9].md")), reverse=True)


def test_breaking_changes_are_the_first_section_of_a_release_page_or_absent():
    for page in RELEASES.glob("[0-9]*.[0-9].md"):
        headings = re.findall(r"^## (.*)$", page.read_text(encoding="utf-8"), re.M)
        assert "Breaking changes" not in headings[1:], page.name


def test_changelog_is_shorter_than_its_line_limit():
    lines = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= MAX_UNRELEASED_LINES, "move what users notice to the page of the release in docs/releases"


def test_security_policy_promises_an_answer_in_7_days():
    text = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
    assert "**Report a vulnerability**" in text
    assert "| within 7 days | an answer" in text

"""What the user's guide shows works, and what it points at exists."""

import re
from pathlib import Path

import pytest

from kinesic.controller.checks import checks
from kinesic.controller.perform import perform
from kinesic.expressivity.lexicon import Lexicon

ROOT = Path(__file__).resolve().parent.parent
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path):
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8"))
    local = [link for link in links if not link.startswith(("http://", "https://"))]
    assert [link for link in local if not (page.parent / link).exists()] == []


def test_the_example_of_the_gesture_page_is_a_lexicon(tmp_path: Path):
    page = (ROOT / "docs" / "my-gestures.md").read_text(encoding="utf-8")
    file = tmp_path / "mine.toml"
    file.write_text(re.findall(r"```toml\n(.*?)```", page, re.DOTALL)[0], encoding="utf-8")
    lexicon = Lexicon.load(file)
    scales, lift = lexicon.find("weigh_up"), lexicon.find("LIFT")
    assert scales is not None
    assert lift is not None
    assert (scales.form.sides, len(scales.form.keys), scales.substitute) == ({"l", "r"}, 2, "")
    assert lift.form.keys[1].hands["l"].position.tolist() == [0.65, 0.5, 0.6]
    assert lift.form.keys[1].hands["l"].fixed == (True, False, False)


def test_the_report_page_names_every_check():
    page = (ROOT / "docs" / "report.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`(\w+\.\w+)`", page[page.index("| check |") :]))
    block = (
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="beat" stroke="1"/></bml>'
    )
    assert {check.name for check in checks(perform(block))} <= named

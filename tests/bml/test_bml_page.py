"""The page about BML lists what the parser reads: each element with each attribute, and nothing else."""

import re
from pathlib import Path
from typing import get_args

import pytest

from kinesic.bml.block import RANGES, BlockCommand, Dialect, NoticeType
from kinesic.bml.parse import parse
from kinesic.bml.reading.elements import ACTIONS
from kinesic.bml.reading.fragments import REWRITTEN, WORDS
from kinesic.bml.reading.json_words import REWRITES
from kinesic.bml.reading.manner import REASON
from kinesic.bml.reading.namespaces import COMPOSING_ATTRIBUTES
from kinesic.bml.reading.script import PAUSE
from kinesic.bml.reading.vocabulary import ATTRIBUTES, INSIDE
from kinesic.bml.timing.points import sync_points

PAGE = (Path(__file__).parents[2] / "docs" / "bml.md").read_text(encoding="utf-8")


def section(title: str) -> str:
    return PAGE.partition(f"\n## {title}\n")[2].partition("\n## ")[0]


def rows(title: str) -> list[tuple[str, str, str]]:
    found = re.findall(r"^\| `(\w+)` \| `([\w-]+)` \| (.+) \|$", section(title), re.MULTILINE)
    assert found, title
    return found


@pytest.mark.parametrize(("title", "read"), [("Behaviours", ATTRIBUTES), ("Elements inside", INSIDE)])
def test_the_page_lists_every_attribute_that_is_read(title: str, read: dict[str, tuple[str, ...]]) -> None:
    written = [(element, attribute) for element, attribute, _ in rows(title)]
    assert len(written) == len(set(written))
    assert set(written) == {(element, name) for element, names in read.items() for name in names}


def test_the_parser_knows_the_attributes_of_every_element() -> None:
    assert ATTRIBUTES.keys() == ACTIONS.keys()


@pytest.mark.parametrize("element", ACTIONS)
def test_an_attribute_is_read_or_warned_of(element: str) -> None:
    attributes = " ".join(f'{name}="1"' for name in ATTRIBUTES[element])
    block = parse(f'<bml id="b"><{element} id="x" {attributes} nonsense="1"/></bml>')
    unread = [notice.text for notice in block.notices if "is not known" in notice.text]
    assert len(unread) == 1
    assert "nonsense" in unread[0]


def test_the_page_lists_the_sync_points_of_every_behaviour() -> None:
    listed = {}
    for names, points in re.findall(r"^\| (`\w+`.*?) \| (start.*) \|$", section("Sync points and references"), re.M):
        listed |= dict.fromkeys(re.findall(r"`(\w+)`", names), points)
    assert listed.keys() == ACTIONS.keys()
    for element, told in listed.items():
        block = parse(f'<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0"><{element} id="x"/></bml>')
        points = sync_points(block.behaviours[0].action, "bml-1.0")
        first = re.split(r"[;,]", told)[0].split()
        assert first == (["start"] if element == "speech" else list(points))


def test_the_page_lists_what_blocks_do_to_one_another() -> None:
    listed = re.findall(r"^\| (`bml`|behaviour) \| `bmla:(\w+)` \|", section("The block"), re.MULTILINE)
    assert {name.lower() for where, name in listed if where == "`bml`"} == COMPOSING_ATTRIBUTES
    commands = [name for where, name in listed if where == "behaviour"]
    for name in commands:
        block = parse(f'<bml id="b"><bmla:{name} id="x" target="other"/></bml>', known_blocks=["other"])
        assert isinstance(block.behaviours[0].action, BlockCommand)
    assert len(commands) == len(get_args(BlockCommand))


def test_the_page_lists_our_own_attributes() -> None:
    listed = set(re.findall(r"`kinesic:(\w+)`", section("Elements inside")))
    assert listed == {"style", REASON, PAUSE, *RANGES}


def test_the_page_lists_every_dialect_and_warning() -> None:
    listed = re.findall(r"^\| `([\w.-]+)` \| .* \| .* \|$", section("Dialects"), re.MULTILINE)
    assert set(listed) == set(get_args(Dialect))
    assert set(re.findall(r"^\| `([A-Z_]+)` \|", section("Warnings"), re.MULTILINE)) == {
        kind.value for kind in NoticeType
    }


def test_the_page_names_every_word_of_other_dialects() -> None:
    fragments = PAGE.partition("### SmartBody")[2].partition("### ")[0]
    assert [word for word in (*REWRITTEN, *WORDS) if word not in fragments] == []
    words = PAGE.partition("### BML as JSON")[2].partition("\n## ")[0]
    assert [word for word in REWRITES.keys() - ACTIONS.keys() if f"`{word}`" not in words] == []

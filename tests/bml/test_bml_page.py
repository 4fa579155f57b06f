"""Tests that docs/reference/bml.md lists exactly the supported elements and attributes."""

import re
from pathlib import Path
from typing import get_args

import pytest

from kinesic.bml.block import EXPRESSIVITY_RANGES, BlockCommand, Dialect, NoticeType
from kinesic.bml.parse import parse
from kinesic.bml.reading.elements import ACTION_READERS
from kinesic.bml.reading.fragments import SMARTBODY_ELEMENTS, SMARTBODY_REWRITERS
from kinesic.bml.reading.json_words import JSON_REWRITERS
from kinesic.bml.reading.manner import REASON_ATTRIBUTE
from kinesic.bml.reading.namespaces import COMPOSITION_ATTRIBUTES
from kinesic.bml.reading.script import PAUSE_ATTRIBUTE
from kinesic.bml.reading.vocabulary import BEHAVIOUR_ATTRIBUTES, NESTED_ATTRIBUTES
from kinesic.bml.timing.points import list_sync_points

# reference page of the supported BML
PAGE_TEXT = (Path(__file__).parents[2] / "docs" / "reference" / "bml.md").read_text(encoding="utf-8")


def section(title: str) -> str:
    return PAGE_TEXT.partition(f"\n## {title}\n")[2].partition("\n## ")[0]


def rows(title: str) -> list[tuple[str, str, str]]:
    table_rows = re.findall(r"^\| `(\w+)` \| `([\w-]+)` \| (.+) \|$", section(title), re.MULTILINE)
    assert table_rows, title
    return table_rows


@pytest.mark.parametrize(
    ("title", "read"), [("Behaviours", BEHAVIOUR_ATTRIBUTES), ("Elements inside", NESTED_ATTRIBUTES)]
)
def test_docs_page_lists_all_supported_attributes(title: str, read: dict[str, tuple[str, ...]]) -> None:
    table_rows = [(element, attribute) for element, attribute, _ in rows(title)]
    assert len(table_rows) == len(set(table_rows))
    assert set(table_rows) == {(element, name) for element, names in read.items() for name in names}


def test_each_behaviour_element_has_an_attribute_table_and_a_reader() -> None:
    assert BEHAVIOUR_ATTRIBUTES.keys() == ACTION_READERS.keys()


@pytest.mark.parametrize("element", ACTION_READERS)
def test_only_the_unknown_attribute_of_a_behaviour_gives_a_notice(element: str) -> None:
    attributes = " ".join(f'{name}="1"' for name in BEHAVIOUR_ATTRIBUTES[element])
    block = parse(f'<bml id="b"><{element} id="x" {attributes} nonsense="1"/></bml>')
    unread = [notice.text for notice in block.notices if "is unknown" in notice.text]
    assert len(unread) == 1
    assert "nonsense" in unread[0]


def test_docs_page_lists_sync_points_of_all_behaviours() -> None:
    listed = {}
    for names, points in re.findall(r"^\| (`\w+`.*?) \| (start.*) \|$", section("Sync points and references"), re.M):
        listed |= dict.fromkeys(re.findall(r"`(\w+)`", names), points)
    assert listed.keys() == ACTION_READERS.keys()
    for element, points_text in listed.items():
        block = parse(f'<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0"><{element} id="x"/></bml>')
        points = list_sync_points(block.behaviours[0].action, "bml-1.0")
        first = re.split(r"[;,]", points_text)[0].split()
        assert first == (["start"] if element == "speech" else list(points))


def test_docs_page_lists_composition_attributes_and_commands() -> None:
    listed = re.findall(r"^\| (`bml`|behaviour) \| `bmla:(\w+)` \|", section("The block"), re.MULTILINE)
    assert {name.lower() for where, name in listed if where == "`bml`"} == COMPOSITION_ATTRIBUTES
    commands = [name for where, name in listed if where == "behaviour"]
    for name in commands:
        block = parse(f'<bml id="b"><bmla:{name} id="x" target="other"/></bml>', known_blocks=["other"])
        assert isinstance(block.behaviours[0].action, BlockCommand)
    assert len(commands) == len(get_args(BlockCommand))


def test_docs_page_lists_kinesic_attributes() -> None:
    listed = set(re.findall(r"`kinesic:(\w+)`", section("Elements inside")))
    assert listed == {"style", REASON_ATTRIBUTE, PAUSE_ATTRIBUTE, *EXPRESSIVITY_RANGES}


def test_docs_page_lists_all_dialects_and_warnings() -> None:
    listed = re.findall(r"^\| `([\w.-]+)` \| .* \| .* \|$", section("Dialects"), re.MULTILINE)
    assert set(listed) == set(get_args(Dialect))
    assert set(re.findall(r"^\| `([A-Z_]+)` \|", section("Warnings"), re.MULTILINE)) == {
        kind.value for kind in NoticeType
    }


def test_docs_page_names_all_elements_of_other_dialects() -> None:
    fragments = PAGE_TEXT.partition("### SmartBody")[2].partition("### ")[0]
    assert [word for word in (*SMARTBODY_REWRITERS, *SMARTBODY_ELEMENTS) if word not in fragments] == []
    words = PAGE_TEXT.partition("### BML as JSON")[2].partition("\n## ")[0]
    assert [word for word in JSON_REWRITERS.keys() - ACTION_READERS.keys() if f"`{word}`" not in words] == []

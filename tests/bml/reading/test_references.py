"""Tests of the grammar of sync references."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from kinesic.bml.block import BmlError, SyncRef
from kinesic.bml.reading.references import Names, parse_ref, split_relation, write_reference

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
EXPECTED_FILE = CORPUS_FOLDER / "expectations" / "syncref.json"
EXPECTED_RESULTS: dict[str, Any] = json.loads(EXPECTED_FILE.read_text()) if EXPECTED_FILE.exists() else {}
KNOWN_NAMES = Names(
    "b", frozenset({"g", "my-nod", "s", "a-2"}), {"tm1": "s", "mid-word": "s"}, frozenset({"other-block"})
)


def _cases(kind: str) -> list[Any]:
    skip = pytest.mark.skip(reason=f"no corpus at {CORPUS_FOLDER}")
    return EXPECTED_RESULTS[kind] if EXPECTED_RESULTS else [pytest.param({}, marks=skip)]


@pytest.mark.parametrize("case", _cases("accepted"))
def test_sync_references_accepted_by_the_corpus_grammar_are_parsed(case: dict[str, Any]) -> None:
    ref = parse_ref(case["input"], Names(case["default_block"]))
    assert ref.offset == pytest.approx(case["offset"], abs=EXPECTED_RESULTS["tolerance"])
    ref = {"block": ref.block, "behaviour": ref.behaviour, "sync": ref.sync, "iteration": ref.iteration}
    assert ref == {field: case[field] for field in ref}


@pytest.mark.parametrize("case", _cases("rejected"))
def test_sync_references_rejected_by_the_corpus_grammar_raise_an_error(case: dict[str, Any]) -> None:
    with pytest.raises(BmlError, match="is not a sync reference; "):
        parse_ref(case["input"], Names(case["default_block"]))


@pytest.mark.parametrize("kind", ["equal", "not_equal"])
def test_sync_references_are_equal_exactly_where_the_corpus_lists_them_as_equal(kind: str) -> None:
    for case in _cases(kind) if EXPECTED_RESULTS else ():
        names = Names(case["default_block"])
        assert (parse_ref(case["a"], names) == parse_ref(case["b"], names)) is (kind == "equal"), case


@pytest.mark.parametrize("case", _cases("written"))
def test_parsed_sync_references_are_written_as_text(case: dict[str, Any]) -> None:
    ref = parse_ref(case["input"], Names(case["default_block"]))
    assert write_reference(ref, relative_to=case.get("relative_to")) == case["text"]


@pytest.mark.parametrize(
    ("text", "ref"),
    [
        ("my-nod:stroke", SyncRef("b", "my-nod", "stroke")),
        ("my-nod:stroke-3", SyncRef("b", "my-nod", "stroke", offset=-3.0)),
        ("a-2:start - 0.5", SyncRef("b", "a-2", "start", offset=-0.5)),
        ("s:mid-word+1", SyncRef("b", "s", "mid-word", offset=1.0)),
        ("other-block:g:start", SyncRef("other-block", "g", "start")),
        ("tm1 + 0.53", SyncRef("b", "s", "tm1", offset=0.53)),
        ("b:end", SyncRef("b", "bml", "end")),
        ("g:start+1e-3", SyncRef("b", "g", "start", offset=0.001)),
        ("1e-3", SyncRef("b", "bml", "start", offset=0.001)),
        (" -.5 ", SyncRef("b", "bml", "start", offset=-0.5)),
        ("+2", SyncRef("b", "bml", "start", offset=2.0)),
        ("1200", SyncRef("b", "bml", "start", offset=1200.0)),
    ],
)
def test_sync_references_beyond_the_bml_grammar_are_parsed(text: str, ref: SyncRef) -> None:
    assert parse_ref(text, KNOWN_NAMES) == ref


@pytest.mark.parametrize(
    "text",
    [
        *(
            "1e9",
            "-1200.1",
            "g:start+1e9",
            "1e999",
            "NaN",
            "inf",
            "-inf",
            "g:start+nan",
            "",
            ":",
            "g:",
            "x-y:start",
            "g:+",
        ),
        *("g:stroke:0", "g:stroke:-1", "g:stroke:x", "a:b:c:d:e", "a:b:stroke:x", "word", "g:start+-1", "g:stroke:²"),
    ],
)
def test_invalid_sync_references_raise_an_error_with_remedy(text: str) -> None:
    with pytest.raises(BmlError, match="; "):
        parse_ref(text, KNOWN_NAMES)


def test_relations_after_and_before_are_split_from_a_sync_reference() -> None:
    assert split_relation("after(s:tm3)") == ("after", "s:tm3")
    assert split_relation(" before( s:tm3+1 ) ") == ("before", " s:tm3+1 ")
    assert split_relation("s:after") == ("at", "s:after")

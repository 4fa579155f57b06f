"""The grammar of sync references."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from kinesic.bml.block import BmlError, SyncRef
from kinesic.bml.reading.references import Names, parse_ref, relation, write_reference

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
EXPECTED = CORPUS / "expectations" / "syncref.json"
DATA: dict[str, Any] = json.loads(EXPECTED.read_text()) if EXPECTED.exists() else {}
NAMES = Names("b", frozenset({"g", "my-nod", "s", "a-2"}), {"tm1": "s", "mid-word": "s"}, frozenset({"other-block"}))


def _cases(kind: str) -> list[Any]:
    skip = pytest.mark.skip(reason=f"no corpus at {CORPUS}")
    return DATA[kind] if DATA else [pytest.param({}, marks=skip)]


@pytest.mark.parametrize("case", _cases("accepted"))
def test_accepted(case: dict[str, Any]) -> None:
    ref = parse_ref(case["input"], Names(case["default_block"]))
    assert ref.offset == pytest.approx(case["offset"], abs=DATA["tolerance"])
    found = {"block": ref.block, "behaviour": ref.behaviour, "sync": ref.sync, "iteration": ref.iteration}
    assert found == {field: case[field] for field in found}


@pytest.mark.parametrize("case", _cases("rejected"))
def test_rejected(case: dict[str, Any]) -> None:
    with pytest.raises(BmlError, match="is no sync reference; "):
        parse_ref(case["input"], Names(case["default_block"]))


@pytest.mark.parametrize("kind", ["equal", "not_equal"])
def test_equality(kind: str) -> None:
    for case in _cases(kind) if DATA else ():
        names = Names(case["default_block"])
        assert (parse_ref(case["a"], names) == parse_ref(case["b"], names)) is (kind == "equal"), case


@pytest.mark.parametrize("case", _cases("written"))
def test_written(case: dict[str, Any]) -> None:
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
def test_beyond_the_reference_grammar(text: str, ref: SyncRef) -> None:
    assert parse_ref(text, NAMES) == ref


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
def test_refused(text: str) -> None:
    with pytest.raises(BmlError, match="; "):
        parse_ref(text, NAMES)


def test_relation() -> None:
    assert relation("after(s:tm3)") == ("after", "s:tm3")
    assert relation(" before( s:tm3+1 ) ") == ("before", " s:tm3+1 ")
    assert relation("s:after") == ("at", "s:after")

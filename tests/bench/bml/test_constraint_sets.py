"""The constraint sets that the reference parser states for its documents."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from kinesic.bench.bml.constraint_sets import After, Constraints, Equals, constraints_of
from kinesic.bml.block import Block, BmlError
from kinesic.bml.parse import parse
from kinesic.bml.timing.constraints import Point

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
EXPECTED = CORPUS / "expectations" / "openbmlparser.json"
if not EXPECTED.exists():
    pytest.skip(f"no corpus at {CORPUS}", allow_module_level=True)

DATA = json.loads(EXPECTED.read_text())
DOCUMENTS = {name: facts for name, facts in DATA["documents"].items() if facts}


def _point(block: str, sync: str) -> Point:
    behaviour, _, name = sync.partition(":")
    return Point(block, behaviour, name)


def _shifted(group: Equals) -> dict[Point, float]:
    """A class with the offset of its first point (by name) taken as 0, so that classes compare."""
    zero = group[min(group)]
    return {point: round(offset - zero, 6) for point, offset in group.items()}


def _same_classes(found: tuple[Equals, ...], wanted: list[list[dict[str, Any]]], block: str) -> bool:
    expected = [{_point(block, m["sync"]): m["offset"] for m in group} for group in wanted]
    key = repr
    return sorted((sorted(_shifted(g).items()) for g in found), key=key) == sorted(
        (sorted(_shifted(g).items()) for g in expected), key=key
    )


def _same_afters(found: tuple[After, ...], wanted: list[dict[str, Any]], block: str) -> bool:
    expected = {}
    for after in wanted:
        ref, targets = after["ref"], after["targets"]
        expected[_point(block, ref["sync"])] = sorted(
            (_point(block, t["sync"]), round(t["offset"] - ref["offset"], 6)) for t in targets
        )
    return {a.point: sorted((p, round(o, 6)) for p, o in a.targets) for a in found} == expected


@pytest.mark.parametrize("name", DOCUMENTS)
def test_documents(name: str) -> None:
    facts = DOCUMENTS[name]
    text = (CORPUS / "openbmlparser" / name).read_bytes()
    if facts["parse"] == "error":
        with pytest.raises(BmlError, match=rf"^{name}:\d+:\d+: .*; "):
            parse(text, source=name)
        return
    block = parse(text, source=name)
    found = constraints_of(block)
    assert facts["block"] in (None, block.id)
    for field, classes in (("constraints", found.classes), ("required_constraints", found.required_classes)):
        if facts[field] is not None:
            assert _same_classes(classes, facts[field], block.id), (field, classes)
    for field, afters in (("after_constraints", found.afters), ("required_after_constraints", found.required_afters)):
        if facts[field] is not None:
            assert _same_afters(afters, facts[field], block.id), (field, afters)
    if facts["behaviour_count"] is not None:
        assert len(block.behaviours) == facts["behaviour_count"]
    if facts["required_behaviours"] is not None:
        assert {b.id: b.required for b in block.behaviours} == facts["required_behaviours"]


@pytest.mark.parametrize("case", DATA["inline"], ids=lambda case: case["test"])
def test_inline(case: dict[str, Any]) -> None:
    if case["parse"] == "error":
        with pytest.raises(BmlError):
            parse(case["bml"], strict=case["strict"])
        return
    found = constraints_of(parse(case["bml"], strict=case["strict"]))
    for fact in case["facts"]:
        assert _normal(_fact(found, fact)) == _normal(fact["value"]), fact


def _fact(found: Constraints, fact: dict[str, Any]) -> object:
    if fact["fact"] == "depends_on_blocks":
        return sorted(found.blocks())
    return getattr(found, fact["fact"])(*fact["behaviours"])


def _normal(value: object) -> object:
    if isinstance(value, list):
        return sorted(sorted(v) if isinstance(v, list) else v for v in value)
    return value


def test_contradicting_equalities_keep_the_first() -> None:
    block: Block = parse('<bml><head id="a" start="b:start+1"/><head id="b" start="a:start+1"/></bml>')
    (group,) = constraints_of(block).classes
    assert group[Point("block", "b", "start")] - group[Point("block", "a", "start")] == 1.0

"""Constraint sets compared with the results of the reference parser."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from kinesic.bench.bml.constraint_sets import Constraints, OrderConstraint, TimeClass, collect_constraints
from kinesic.bml.block import Block, BmlError
from kinesic.bml.parse import parse
from kinesic.bml.timing.constraints import Point

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
EXPECTATION_FILE = CORPUS_FOLDER / "expectations" / "openbmlparser.json"
if not EXPECTATION_FILE.exists():
    pytest.skip(f"no corpus at {CORPUS_FOLDER}", allow_module_level=True)

EXPECTATIONS = json.loads(EXPECTATION_FILE.read_text())
EXPECTED_DOCUMENTS = {name: facts for name, facts in EXPECTATIONS["documents"].items() if facts}


def _point(block: str, sync: str) -> Point:
    behaviour, _, name = sync.partition(":")
    return Point(block, behaviour, name)


def _shifted(group: TimeClass) -> dict[Point, float]:
    """Return a rigid set with offsets [s] relative to its alphabetically first point."""
    zero = group[min(group)]
    return {point: round(offset - zero, 6) for point, offset in group.items()}


def _same_classes(constraints: tuple[TimeClass, ...], expected_sets: list[list[dict[str, Any]]], block: str) -> bool:
    expected = [{_point(block, m["sync"]): m["offset"] for m in group} for group in expected_sets]
    key = repr
    return sorted((sorted(_shifted(g).items()) for g in constraints), key=key) == sorted(
        (sorted(_shifted(g).items()) for g in expected), key=key
    )


def _same_afters(constraints: tuple[OrderConstraint, ...], expected_sets: list[dict[str, Any]], block: str) -> bool:
    expected = {}
    for after in expected_sets:
        ref, targets = after["ref"], after["targets"]
        expected[_point(block, ref["sync"])] = sorted(
            (_point(block, t["sync"]), round(t["offset"] - ref["offset"], 6)) for t in targets
        )
    return {a.point: sorted((p, round(o, 6)) for p, o in a.targets) for a in constraints} == expected


@pytest.mark.parametrize("name", EXPECTED_DOCUMENTS)
def test_time_constraints_of_corpus_documents_equal_those_of_the_reference_parser(name: str) -> None:
    facts = EXPECTED_DOCUMENTS[name]
    text = (CORPUS_FOLDER / "openbmlparser" / name).read_bytes()
    if facts["parse"] == "error":
        with pytest.raises(BmlError, match=rf"^{name}:\d+:\d+: .*; "):
            parse(text, source=name)
        return
    block = parse(text, source=name)
    constraints = collect_constraints(block)
    assert facts["block"] in (None, block.id)
    for field, classes in (
        ("constraints", constraints.classes),
        ("required_constraints", constraints.required_classes),
    ):
        if facts[field] is not None:
            assert _same_classes(classes, facts[field], block.id), (field, classes)
    for field, afters in (
        ("after_constraints", constraints.afters),
        ("required_after_constraints", constraints.required_afters),
    ):
        if facts[field] is not None:
            assert _same_afters(afters, facts[field], block.id), (field, afters)
    if facts["behaviour_count"] is not None:
        assert len(block.behaviours) == facts["behaviour_count"]
    if facts["required_behaviours"] is not None:
        assert {b.id: b.required for b in block.behaviours} == facts["required_behaviours"]


@pytest.mark.parametrize("case", EXPECTATIONS["inline"], ids=lambda case: case["test"])
def test_time_constraints_of_small_blocks_equal_those_of_the_reference_parser(case: dict[str, Any]) -> None:
    if case["parse"] == "error":
        with pytest.raises(BmlError):
            parse(case["bml"], strict=case["strict"])
        return
    constraints = collect_constraints(parse(case["bml"], strict=case["strict"]))
    for fact in case["facts"]:
        assert _normal(_fact(constraints, fact)) == _normal(fact["value"]), fact


def _fact(constraints: Constraints, fact: dict[str, Any]) -> object:
    if fact["fact"] == "depends_on_blocks":
        return sorted(constraints.referenced_blocks())
    return getattr(constraints, fact["fact"])(*fact["behaviours"])


def _normal(value: object) -> object:
    if isinstance(value, list):
        return sorted(sorted(v) if isinstance(v, list) else v for v in value)
    return value


def test_first_of_two_contradicting_time_equations_is_kept() -> None:
    block: Block = parse('<bml><head id="a" start="b:start+1"/><head id="b" start="a:start+1"/></bml>')
    (group,) = collect_constraints(block).classes
    assert group[Point("block", "b", "start")] - group[Point("block", "a", "start")] == 1.0

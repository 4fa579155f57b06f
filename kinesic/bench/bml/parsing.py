"""Holds what documents mean, before any time is known, against what the reference parser's tests state."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from kinesic.bench.bml.constraint_sets import After, Constraints, Equals, constraints_of
from kinesic.bench.bml.expectations import (
    ExpectationVerdict,
    Fact,
    Inline,
    Later,
    Parsing,
    ReferenceExpectation,
    ReferenceSuite,
    Stated,
    Time,
)
from kinesic.bml.block import Block, BmlError, SyncRef
from kinesic.bml.parse import parse
from kinesic.bml.reading.references import Names, parse_ref, write_reference
from kinesic.bml.timing.constraints import Point

_DIGITS = 6  # of offsets that are compared [s]


def judge_parsing(suite: str, where: Path, expected: Parsing) -> Iterator[ExpectationVerdict]:
    """Judges documents and small blocks.

    Args:
        suite: name of the suite.
        where: folder of its documents.
        expected: what is stated about them.
    """
    for name, stated in expected.documents.items():
        if stated is not None:
            yield ExpectationVerdict(suite, name, _document((where / name).read_bytes(), stated))
    for inline in expected.inline:
        yield ExpectationVerdict(suite, inline.test, _inline(inline))


def judge_references(suite: str, expected: ReferenceSuite) -> Iterator[ExpectationVerdict]:
    """Judges sync references by themselves.

    Args:
        suite: name of the suite.
        expected: what is stated about them.
    """
    for case in expected.accepted:
        yield ExpectationVerdict(suite, case.test, _accepted(case, expected.tolerance))
    for case in expected.rejected:
        found = _read(case.input, case)
        yield ExpectationVerdict(
            suite, case.test, "" if isinstance(found, BmlError) else f"'{case.input}' is taken as {found}"
        )
    for cases, alike in ((expected.equal, True), (expected.not_equal, False)):
        for case in cases:
            same = _read(case.a, case) == _read(case.b, case)
            why = "" if same is alike else f"'{case.a}' and '{case.b}' are {'the same' if same else 'different'}"
            yield ExpectationVerdict(suite, case.test, why)
    for case in expected.written:
        found = _read(case.input, case)
        text = str(found) if isinstance(found, BmlError) else write_reference(found, relative_to=case.relative_to)
        yield ExpectationVerdict(
            suite, case.test, "" if text == case.text else f"'{text}' is written, '{case.text}' is expected"
        )


def _read(text: str, case: ReferenceExpectation) -> SyncRef | BmlError:
    try:
        return parse_ref(text, Names(case.default_block))
    except BmlError as error:
        return error


def _accepted(case: ReferenceExpectation, tolerance: float) -> str:
    try:
        ref = parse_ref(case.input, Names(case.default_block))
    except BmlError as error:
        return str(error)
    found = (ref.block, ref.behaviour, ref.sync, ref.iteration)
    wanted = (case.block, case.behaviour, case.sync, case.iteration)
    near = abs(ref.offset - case.offset) <= tolerance
    return "" if found == wanted and near else f"'{case.input}' is taken as {ref}"


def _document(text: bytes, stated: Stated) -> str:
    try:
        block = parse(text)
    except BmlError as error:
        return "" if stated.parse == "error" else str(error)
    if stated.parse == "error":
        return "is read, and should be refused"
    return next(filter(None, _differences(block, stated)), "")


def _differences(block: Block, stated: Stated) -> Iterator[str]:
    found = constraints_of(block)
    if stated.block not in (None, block.id):
        yield f"is block {block.id}, not {stated.block}"
    classes = (
        ("constraints", found.classes, stated.constraints),
        ("required constraints", found.required_classes, stated.required_constraints),
    )
    for what, have, want in classes:
        if want is not None and _classes(have) != _classes(_groups(want, block.id)):
            yield f"{what} are {_classes(have)}, not {_classes(_groups(want, block.id))}"
    afters = (
        ("after-constraints", found.afters, stated.after_constraints),
        ("required after-constraints", found.required_afters, stated.required_after_constraints),
    )
    for what, later, wanted in afters:
        if wanted is not None and _afters(later) != _stated_afters(wanted):
            yield f"{what} are {_afters(later)}, not {_stated_afters(wanted)}"
    if stated.behaviour_count not in (None, len(block.behaviours)):
        yield f"has {len(block.behaviours)} behaviours, not {stated.behaviour_count}"
    required = {behaviour.id: behaviour.required for behaviour in block.behaviours}
    if stated.required_behaviours not in (None, required):
        yield f"requires {required}, not {stated.required_behaviours}"


def _inline(inline: Inline) -> str:
    try:
        found = constraints_of(parse(inline.bml, strict=inline.strict))
    except BmlError as error:
        return "" if inline.parse == "error" else str(error)
    if inline.parse == "error":
        return "is read, and should be refused"
    wrong = (f"{fact.fact} {' '.join(fact.behaviours)} is not {fact.value}" for fact in inline.facts)
    return next((why for why, fact in zip(wrong, inline.facts, strict=True) if not _holds(found, fact)), "")


def _holds(found: Constraints, fact: Fact) -> bool:
    """Whether a fact about behaviours is so; the order within lists has no meaning."""
    names = fact.behaviours
    match fact.fact:
        case "depends_on_blocks":
            return sorted(found.blocks()) == _sorted(fact.value)
        case "ungrounded_loops":
            return sorted(map(sorted, found.ungrounded_loops(names[0]))) == _sorted(fact.value)
        case "directly_linked":
            return found.directly_linked(names[0], names[1]) is fact.value
        case "connected":
            return found.connected(names[0], names[1]) is fact.value
        case "directly_grounded":
            return found.directly_grounded(names[0]) is fact.value
        case "directly_after_grounded":
            return found.directly_after_grounded(names[0]) is fact.value
        case "grounded":
            return found.grounded(names[0]) is fact.value
    return False


def _sorted(value: bool | Sequence[str | Sequence[str]]) -> list[str | list[str]]:
    if isinstance(value, bool):
        return []
    names = [each for each in value if isinstance(each, str)]
    return [*sorted(names), *sorted(sorted(each) for each in value if not isinstance(each, str))]


def _point(sync: str, block: str) -> Point:
    behaviour, _, name = sync.partition(":")
    return Point(block, behaviour, name)


def _groups(stated: Iterable[Sequence[Time]], block: str) -> list[Equals]:
    return [{_point(time.sync, block): time.offset for time in group} for group in stated]


def _classes(groups: Iterable[Equals]) -> list[list[tuple[str, float]]]:
    """Classes of equal times, each from its first point by name, so that they compare."""
    return sorted(
        [(":".join(point[1:]), round(offset - group[min(group)], _DIGITS)) for point, offset in sorted(group.items())]
        for group in groups
    )


Orders = dict[str, list[tuple[str, float]]]  # point -> those that are not before it, and by how much


def _afters(found: Iterable[After]) -> Orders:
    return {
        ":".join(after.point[1:]): sorted((":".join(point[1:]), round(gap, _DIGITS)) for point, gap in after.targets)
        for after in found
    }


def _stated_afters(stated: Iterable[Later]) -> Orders:
    orders: Orders = {}
    for later in stated:
        flat = [t for target in later.targets for t in ((target,) if isinstance(target, Time) else target)]
        orders[later.ref.sync] = sorted((t.sync, round(t.offset - later.ref.offset, _DIGITS)) for t in flat)
    return orders

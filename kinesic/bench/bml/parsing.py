"""Comparison of parsed constraints with the expectations of the reference parser."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from kinesic.bench.bml.constraint_sets import Constraints, OrderConstraint, TimeClass, collect_constraints
from kinesic.bench.bml.expectations import (
    AfterExpectation,
    BehaviourFact,
    DocumentExpectation,
    ExpectationVerdict,
    InlineExpectation,
    ParsingSuite,
    ReferenceExpectation,
    ReferenceSuite,
    SyncOffset,
)
from kinesic.bml.block import Block, BmlError, SyncRef
from kinesic.bml.parse import parse
from kinesic.bml.reading.references import Names, parse_ref, write_reference
from kinesic.bml.timing.constraints import Point

_OFFSET_DECIMALS = 6  # decimal places of compared time offsets


def judge_parsing(suite: str, folder: Path, expected: ParsingSuite) -> Iterator[ExpectationVerdict]:
    """Yield verdicts on the parsed constraints of documents and inline blocks.

    Args:
        suite: name of the suite.
        folder: folder of its documents.
        expected: expectations about the documents.
    """
    for name, expectation in expected.documents.items():
        if expectation is not None:
            yield ExpectationVerdict(suite, name, _judge_document((folder / name).read_bytes(), expectation))
    for inline in expected.inline:
        yield ExpectationVerdict(suite, inline.test, _judge_inline(inline))


def judge_references(suite: str, expected: ReferenceSuite) -> Iterator[ExpectationVerdict]:
    """Yield verdicts on parsing, comparing and writing sync references.

    Args:
        suite: name of the suite.
        expected: expectations about the references.
    """
    for case in expected.accepted:
        yield ExpectationVerdict(suite, case.test, _judge_accepted(case, expected.tolerance))
    for case in expected.rejected:
        actual = _read(case.input, case)
        yield ExpectationVerdict(
            suite, case.test, "" if isinstance(actual, BmlError) else f"'{case.input}' is read as {actual}"
        )
    for cases, alike in ((expected.equal, True), (expected.not_equal, False)):
        for case in cases:
            same = _read(case.a, case) == _read(case.b, case)
            why = "" if same is alike else f"'{case.a}' and '{case.b}' are {'the same' if same else 'different'}"
            yield ExpectationVerdict(suite, case.test, why)
    for case in expected.written:
        actual = _read(case.input, case)
        text = str(actual) if isinstance(actual, BmlError) else write_reference(actual, relative_to=case.relative_to)
        yield ExpectationVerdict(
            suite, case.test, "" if text == case.text else f"'{text}' is written instead of '{case.text}'"
        )


def _read(text: str, case: ReferenceExpectation) -> SyncRef | BmlError:
    try:
        return parse_ref(text, Names(case.default_block))
    except BmlError as error:
        return error


def _judge_accepted(case: ReferenceExpectation, tolerance: float) -> str:
    try:
        ref = parse_ref(case.input, Names(case.default_block))
    except BmlError as error:
        return str(error)
    actual = (ref.block, ref.behaviour, ref.sync, ref.iteration)
    required = (case.block, case.behaviour, case.sync, case.iteration)
    is_offset_right = abs(ref.offset - case.offset) <= tolerance
    return "" if actual == required and is_offset_right else f"'{case.input}' is read as {ref}"


def _judge_document(text: bytes, expectation: DocumentExpectation) -> str:
    try:
        block = parse(text)
    except BmlError as error:
        return "" if expectation.parse == "error" else str(error)
    if expectation.parse == "error":
        return "is accepted but should be refused"
    return next(filter(None, _differences(block, expectation)), "")


def _differences(block: Block, expectation: DocumentExpectation) -> Iterator[str]:
    actual = collect_constraints(block)
    if expectation.block not in (None, block.id):
        yield f"is block {block.id}, not {expectation.block}"
    classes = (
        ("constraints", actual.classes, expectation.constraints),
        ("required constraints", actual.required_classes, expectation.required_constraints),
    )
    for kind, have, want in classes:
        if want is not None and _sort_classes(have) != _sort_classes(_groups(want, block.id)):
            yield f"{kind} are {_sort_classes(have)}, not {_sort_classes(_groups(want, block.id))}"
    afters = (
        ("after-constraints", actual.afters, expectation.after_constraints),
        ("required after-constraints", actual.required_afters, expectation.required_after_constraints),
    )
    for kind, later, expected_orders in afters:
        if expected_orders is not None and _afters(later) != _expected_afters(expected_orders):
            yield f"{kind} are {_afters(later)}, not {_expected_afters(expected_orders)}"
    if expectation.behaviour_count not in (None, len(block.behaviours)):
        yield f"has {len(block.behaviours)} behaviours, not {expectation.behaviour_count}"
    required = {behaviour.id: behaviour.required for behaviour in block.behaviours}
    if expectation.required_behaviours not in (None, required):
        yield f"requires {required}, not {expectation.required_behaviours}"


def _judge_inline(inline: InlineExpectation) -> str:
    try:
        actual = collect_constraints(parse(inline.bml, strict=inline.strict))
    except BmlError as error:
        return "" if inline.parse == "error" else str(error)
    if inline.parse == "error":
        return "is accepted but should be refused"
    wrong = (f"{fact.fact} {' '.join(fact.behaviours)} is not {fact.value}" for fact in inline.facts)
    return next((why for why, fact in zip(wrong, inline.facts, strict=True) if not _is_true(actual, fact)), "")


def _is_true(actual: Constraints, fact: BehaviourFact) -> bool:
    """Return whether a query about behaviours has the expected result.

    The order within lists has no meaning.
    """
    names = fact.behaviours
    match fact.fact:
        case "depends_on_blocks":
            return sorted(actual.referenced_blocks()) == _sorted(fact.value)
        case "ungrounded_loops":
            return sorted(map(sorted, actual.ungrounded_loops(names[0]))) == _sorted(fact.value)
        case "directly_linked":
            return actual.directly_linked(names[0], names[1]) is fact.value
        case "connected":
            return actual.connected(names[0], names[1]) is fact.value
        case "directly_grounded":
            return actual.directly_grounded(names[0]) is fact.value
        case "directly_after_grounded":
            return actual.directly_after_grounded(names[0]) is fact.value
        case "grounded":
            return actual.grounded(names[0]) is fact.value
    return False


def _sorted(value: bool | Sequence[str | Sequence[str]]) -> list[str | list[str]]:
    if isinstance(value, bool):
        return []
    names = [name for name in value if isinstance(name, str)]
    return [*sorted(names), *sorted(sorted(group) for group in value if not isinstance(group, str))]


def _point(sync: str, block: str) -> Point:
    behaviour, _, name = sync.partition(":")
    return Point(block, behaviour, name)


def _groups(expectation: Iterable[Sequence[SyncOffset]], block: str) -> list[TimeClass]:
    return [{_point(time.sync, block): time.offset for time in group} for group in expectation]


def _sort_classes(groups: Iterable[TimeClass]) -> list[list[tuple[str, float]]]:
    """Return sets of rigidly linked sync points in a sorted, comparable form.

    Offsets are relative to the first point by name.
    """
    return sorted(
        [
            (":".join(point[1:]), round(offset - group[min(group)], _OFFSET_DECIMALS))
            for point, offset in sorted(group.items())
        ]
        for group in groups
    )


Orders = dict[str, list[tuple[str, float]]]  # sync point -> sync points that must not precede it, with offsets [s]


def _afters(actual: Iterable[OrderConstraint]) -> Orders:
    return {
        ":".join(after.point[1:]): sorted(
            (":".join(point[1:]), round(gap, _OFFSET_DECIMALS)) for point, gap in after.targets
        )
        for after in actual
    }


def _expected_afters(expectation: Iterable[AfterExpectation]) -> Orders:
    orders: Orders = {}
    for later in expectation:
        flat = [t for target in later.targets for t in ((target,) if isinstance(target, SyncOffset) else target)]
        orders[later.ref.sync] = sorted((t.sync, round(t.offset - later.ref.offset, _OFFSET_DECIMALS)) for t in flat)
    return orders

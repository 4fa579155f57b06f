"""Schedules are exact, ordered and independent of names and time origin."""

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import Behaviour, Block, Precedence, Speech, Synchronize, SyncRef, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.bml.timing.constraints import find_equalities, get_point
from kinesic.body.utterance import Utterance

from ...examples import examples
from ...naming import about

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
# files that are refused and therefore not scheduled
REFUSED_FILES = ("testinvalidxml.xml", "testspeech_unknownbehavior.xml")
CORPUS_FILES = sorted(
    path
    for folder in ("greta/bml", "openbmlparser", "asap")
    for path in (CORPUS_FOLDER / folder).rglob("*.xml")
    if path.name not in REFUSED_FILES
)
SECONDS_PER_LETTER = 0.1  # [s] spoken duration of each letter
TIME_TOLERANCE = 1e-9  # [s] largest difference of equal times
SYNC_POINTS = ("start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end")


def _spoken(block: Block) -> dict[str, Utterance]:
    return {
        b.id: Utterance(
            SECONDS_PER_LETTER * len(b.action.script.text),
            {mark.name: SECONDS_PER_LETTER * mark.position for mark in b.action.script.marks},
        )
        for b in block.behaviours
        if isinstance(b.action, Speech)
    }


def _scheduled(block: Block) -> Timeline:
    return schedule(block, _spoken(block), {})


def _times(timeline: Timeline) -> dict[tuple[str, str], float]:
    return {(timed.behaviour.id, sync): time for timed in timeline.timed for sync, time in timed.times.items()}


offsets = st.integers(-8, 8).map(lambda quarter: quarter / 4)


@st.composite
def documents(draw: st.DrawFn) -> str:
    """Draw small blocks of speeches and gestures that refer to each other."""
    count = draw(st.integers(1, 5))
    names = [f"x{i}" for i in range(count)]

    def ref() -> str:
        kind = draw(st.integers(0, 3))
        offset = draw(offsets)
        if kind == 0:
            return str(20 + 4 * offset)
        point = draw(st.sampled_from((*SYNC_POINTS[:1], "end", "stroke" if kind == 1 else "start")))
        return f"{draw(st.sampled_from(names))}:{point}{offset:+}"

    parts = []
    for name in names:
        if draw(st.integers(0, 3)) == 0:
            when = f'start="{ref()}"' if draw(st.booleans()) else ""
            parts.append(f'<speech id="{name}" {when}><text>one <sync id="stroke"/>two three</text></speech>')
            continue
        points = draw(st.lists(st.sampled_from(SYNC_POINTS), max_size=2, unique=True))
        syncs = " ".join(f'{point}="{ref()}"' for point in points)
        parts.append(f'<gesture id="{name}" lexeme="BEAT" {syncs}/>')
    kind = draw(st.sampled_from(("", "synchronize", "after", "before")))
    if kind:
        own = "" if kind == "synchronize" else f' ref="{ref()}"'
        parts.append(f'<constraint><{kind}{own}><sync ref="{ref()}"/><sync ref="{ref()}"/></{kind}></constraint>')
    return f'<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">{"".join(parts)}</bml>'


@examples(200)
@given(documents())
def test_scheduled_sync_points_satisfy_equalities_exactly_and_are_ordered(text: str) -> None:
    block = parse(text)
    timeline = _scheduled(block)
    times = _times(timeline)
    assert {d.behaviour.id for d in timeline.dropped} | {t.behaviour.id for t in timeline.timed} == {
        b.id for b in block.behaviours
    }
    for timed in timeline.timed:
        own = list(timed.times.values())
        assert own == sorted(own)
    performed = replace(block, behaviours=tuple(timed.behaviour for timed in timeline.timed), constraints=())
    for equality in find_equalities(performed):
        left, right = (_time(ref, times) for ref in (equality.left, equality.right))
        assert left == pytest.approx(right, abs=TIME_TOLERANCE)


@examples(120)
@given(documents())
def test_time_constraints_hold_if_no_behaviour_is_dropped(text: str) -> None:
    block = parse(text)
    timeline = _scheduled(block)
    if timeline.notices:
        return
    times = _times(timeline)
    for constraint in block.constraints:
        if isinstance(constraint, Synchronize):
            first, *others = (_time(ref, times) for ref in constraint.refs)
            if any(ref.behaviour != "bml" for ref in constraint.refs):
                assert others == pytest.approx([first] * len(others), abs=TIME_TOLERANCE)
        else:
            assert all(
                _time(constraint.earlier, times) <= _time(ref, times) + TIME_TOLERANCE for ref in constraint.later
            )


@examples(80)
@given(documents(), st.permutations([f"n{i}" for i in range(5)]))
def test_schedule_is_independent_of_behaviour_names(text: str, names: list[str]) -> None:
    block = parse(text)
    new = {b.id: names[i] for i, b in enumerate(block.behaviours)}
    _assert_same(_scheduled(block), _scheduled(_renamed(block, new)), new, shift=0.0)


@examples(80)
@given(documents(), st.integers(0, 400).map(lambda quarter: quarter / 4))
def test_schedule_is_independent_of_the_time_origin(text: str, shift: float) -> None:
    """Shift the absolute times of a block by a constant."""
    block = parse(text)
    before, after = _scheduled(block), _scheduled(_shifted(block, shift))
    assert [d.behaviour.id for d in before.dropped] == [d.behaviour.id for d in after.dropped]
    moved, stayed = _times(after), _times(before)
    for timed in before.timed:
        gaps = {round(moved[timed.behaviour.id, s] - stayed[timed.behaviour.id, s], 6) for s in timed.times}
        if not block.constraints:
            assert gaps in ({0.0}, {round(shift, 6)}), timed.behaviour.id


@pytest.mark.soak
@pytest.mark.skipif(not CORPUS_FILES, reason=f"no corpus at {CORPUS_FOLDER}")
def test_corpus_schedules_are_independent_of_behaviour_names_and_time_origin() -> None:
    for path in CORPUS_FILES:
        with about(path):
            block = _shifted(_grounded(parse(path.read_bytes(), source=path.name)), 50.0)
            new = {behaviour.id: f"n{index}" for index, behaviour in enumerate(block.behaviours)}
            _assert_same(_scheduled(block), _scheduled(_shifted(_renamed(block, new), 30.0)), new, shift=30.0)


def _grounded(block: Block) -> Block:
    """Start untimed behaviours at the block's start, so that they shift with it."""
    free = {b.id for b in block.behaviours if not b.syncs}
    anchor = {"start": SyncRef(block.id, "bml", "start")}
    tied = {ref.behaviour for b in block.behaviours for ref in b.syncs.values()}
    return replace(
        block,
        behaviours=tuple(
            replace(b, syncs=anchor) if b.id in free and (b.id not in tied or isinstance(b.action, Speech)) else b
            for b in block.behaviours
        ),
        constraints=(),
    )


def _assert_same(one: Timeline, other: Timeline, new: Mapping[str, str], *, shift: float) -> None:
    assert [new[d.behaviour.id] for d in one.dropped] == [d.behaviour.id for d in other.dropped]
    expected = {(new[name], sync): time + shift for (name, sync), time in _times(one).items()}
    assert _times(other) == pytest.approx(expected, abs=1e-6)


def _time(ref: SyncRef, times: Mapping[tuple[str, str], float]) -> float:
    return (0.0 if ref.behaviour == "bml" else times[ref.behaviour, get_point(ref).sync]) + ref.offset


def _changed(block: Block, ref_of: dict[SyncRef, SyncRef]) -> Block:
    behaviours = tuple(replace(b, syncs={s: ref_of[r] for s, r in b.syncs.items()}) for b in block.behaviours)
    constraints = tuple(
        replace(c, refs=tuple(ref_of[r] for r in c.refs))
        if isinstance(c, Synchronize)
        else replace(c, earlier=ref_of[c.earlier], later=tuple(ref_of[r] for r in c.later))
        for c in block.constraints
    )
    return replace(block, behaviours=behaviours, constraints=constraints)


def _refs(block: Block) -> list[SyncRef]:
    refs = [ref for b in block.behaviours for ref in b.syncs.values()]
    for c in block.constraints:
        refs += [c.earlier, *c.later] if isinstance(c, Precedence) else c.refs
    return refs


def _renamed(block: Block, new: Mapping[str, str]) -> Block:
    renamed: list[Behaviour] = [replace(b, id=new[b.id]) for b in block.behaviours]
    refs = {r: replace(r, behaviour=new.get(r.behaviour, r.behaviour)) for r in _refs(block)}
    return _changed(replace(block, behaviours=tuple(renamed)), refs)


def _shifted(block: Block, shift: float) -> Block:
    refs = {r: replace(r, offset=r.offset + shift) if r.behaviour == "bml" else r for r in _refs(block)}
    return _changed(block, refs)


@examples(120)
@given(documents(), st.lists(st.tuples(st.sampled_from(SYNC_POINTS), offsets, st.booleans()), min_size=1, max_size=3))
def test_sync_times_relative_to_the_block_end_are_ordered_and_bounded(
    text: str, ends: list[tuple[str, float, bool]]
) -> None:
    refs = [f"bml:end{-abs(offset):+}" for _, offset, _ in ends]
    texts = [f"after({ref})" if after else ref for ref, (_, _, after) in zip(refs, ends, strict=True)]
    written = "".join(
        f'<gesture id="e{k}" lexeme="BEAT" {point}="{ref}"/>'
        for k, ((point, _, _), ref) in enumerate(zip(ends, texts, strict=True))
    )
    timeline = _scheduled(parse(text.replace("</bml>", f"{written}</bml>")))
    for timed in timeline.timed:
        own = list(timed.times.values())
        assert own == sorted(own)
        assert max(map(abs, own)) < 200.0

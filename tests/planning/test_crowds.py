"""Tests of documents with too many behaviours: bounded work, reported drops."""

import random
from collections.abc import Callable, Mapping

import numpy as np
import pytest

from kinesic.bench.blocks import write_overlapping_block
from kinesic.bench.plan import count_violations
from kinesic.bml.block import Timeline
from kinesic.bml.parse import parse
from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.hands.busy_hands import Clashes
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion import infeasibility, key_time_lp, key_times
from kinesic.motion.infeasibility import Infeasibility
from kinesic.motion.key_time_lp import KeyTimeProblem
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.segments import SplineSegment
from kinesic.motion.spline_program import Relaxation
from kinesic.planning import clashes
from kinesic.planning import plan as plan_module
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan

BML_NAMESPACE = "http://www.bml-initiative.org/bml/bml-1.0"  # namespace of BML 1.0


@pytest.fixture
def planned(known: Setup) -> Callable[[str], Plan]:
    """Plan behaviours as one block."""
    return lambda behaviours: plan_block(parse(f'<bml xmlns="{BML_NAMESPACE}" id="b">{behaviours}</bml>'), known)


OVERLAPPING_GESTURES = "".join(  # 24 gestures with strokes 0.11 s apart
    f'<gesture id="g{k}" lexeme="{("offer", "large")[k % 2]}" stroke="{1 + 0.11 * k:.2f}"/>' for k in range(24)
)


@pytest.fixture
def measured(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Count the evaluated spline segments."""
    pieces: list[int] = []
    measure = key_times.measure_time_deficit

    def count(
        segment: SplineSegment, limits: Limits, *, target: float | None = None, max_work: float = np.inf
    ) -> Infeasibility | None:
        pieces.append(segment.grid.pieces)
        return measure(segment, limits, target=target, max_work=max_work)

    monkeypatch.setattr(key_times, "measure_time_deficit", count)
    return pieces


@pytest.mark.soak
def test_reused_cutting_planes_save_a_fifth_of_the_segment_evaluations_of_overlapping_gestures(
    known: Setup, measured: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    text = write_overlapping_block(84, [form.id for form in known.lexicon.forms])
    plan(text, known)
    taken = sum(measured)
    measured.clear()
    monkeypatch.setattr(PlaneMemory, "learn", lambda *given: None)
    plan(text, known)
    assert 0 < taken < 0.8 * sum(measured)


def test_overlapping_gestures_beyond_the_planning_budget_are_dropped_and_the_work_is_bounded(
    planned, monkeypatch, measured
):
    monkeypatch.setattr(plan_module, "WORK_BUDGET", 0)
    monkeypatch.setattr(clashes, "SEARCH_BUDGET", 0)
    made, again = planned(OVERLAPPING_GESTURES), planned(OVERLAPPING_GESTURES)
    outcomes = made.keyframes.outcomes
    kinds = [outcome.kind for outcome in outcomes.values()]
    assert 0 < kinds.count("dropped") < len(kinds)
    assert outcomes["g0"].kind != "dropped"
    assert any("more than the planning budget allows" in outcome.why for outcome in outcomes.values())
    assert sum(measured) < 2 * key_times.SEARCH_TUNING.max_evaluations
    assert {id: one.why for id, one in outcomes.items()} == {
        id: one.why for id, one in again.keyframes.outcomes.items()
    }
    assert count_violations(made) == 0


def test_plan_of_three_gestures_is_equal_with_an_unlimited_planning_budget(planned, monkeypatch):
    row = "".join(f'<gesture id="g{k}" lexeme="large" stroke="{1 + 0.5 * k:.2f}"/>' for k in range(3))
    usual = planned(row)
    monkeypatch.setattr(plan_module, "WORK_BUDGET", np.inf)
    monkeypatch.setattr(clashes, "SEARCH_BUDGET", np.inf)
    np.testing.assert_array_equal(planned(row).motion.planned, usual.motion.planned)


def test_planning_of_long_repeated_nods_stays_within_the_work_budget(planned, monkeypatch):
    work = 3000
    monkeypatch.setattr(plan_module, "WORK_BUDGET", work)
    pieces: list[int] = []
    relax = infeasibility.relax_limits

    def counted(segment: SplineSegment, limits: Limits, *, easy: float, target: float) -> Relaxation | None:
        pieces.append(segment.grid.pieces)
        return relax(segment, limits, easy=easy, target=target)

    monkeypatch.setattr(infeasibility, "relax_limits", counted)

    def count_pieces(heads: int) -> int:
        pieces.clear()
        nods = (
            f'<head id="h{k}" lexeme="NOD" repetition="100" start="{5 * k}" end="{5 * k + 5}"/>' for k in range(heads)
        )
        made = planned("".join(nods))
        assert {notice.id for notice in made.notices} == {f"b:h{k}" for k in range(heads)}
        return sum(pieces)

    assert count_pieces(4) <= work


def mixed_crowd(count: int) -> str:
    """Write behaviours of six kinds at random times, nine per second."""
    chance = random.Random(1)
    kinds = (
        '<head id="x{k}" lexeme="NOD" start="{start:.2f}"/>',
        '<gesture id="x{k}" lexeme="BEAT" start="{start:.2f}"/>',
        '<gaze id="x{k}" target="left" start="{start:.2f}" end="{end:.2f}"/>',
        '<gazeShift id="x{k}" target="right" start="{start:.2f}"/>',
        '<posture id="x{k}" start="{start:.2f}" end="{end:.2f}"><pose part="ARMS" lexeme="ARMS_AKIMBO"/></posture>',
        '<pointing id="x{k}" target="front" start="{start:.2f}"/>',
    )
    starts = ((k, chance.uniform(0, count / 9)) for k in range(count))
    return "".join(kinds[k % len(kinds)].format(k=k, start=start, end=start + 2) for k, start in starts)


@pytest.mark.soak
def test_four_times_more_overlapping_behaviours_take_at_most_one_more_planning_round(known: Setup, monkeypatch):
    monkeypatch.setattr(plan_module, "WORK_BUDGET", 3000)
    monkeypatch.setattr(clashes, "SEARCH_BUDGET", 3000)
    rounds: list[int] = []
    make = plan_module.make_keyframes

    def counted(
        timeline: Timeline, context: BlockContext, *, without: Mapping[str, str], clashes: Clashes
    ) -> KeyFrames:
        rounds.append(len(timeline.timed))
        return make(timeline, context, without=without, clashes=clashes)

    monkeypatch.setattr(plan_module, "make_keyframes", counted)

    def count_rounds(count: int) -> int:
        rounds.clear()
        text = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{mixed_crowd(count)}</bml>'
        made = plan_block(parse(text), known)
        dropped = {id: outcome.why for id, outcome in made.keyframes.outcomes.items() if outcome.kind == "dropped"}
        assert dropped
        assert all(dropped.values())
        return len(rounds)

    assert count_rounds(120) <= count_rounds(30) + 1


@pytest.mark.soak
def test_simultaneous_repeated_nods_need_no_large_linear_program(known: Setup, monkeypatch):
    solved: list[int] = []
    exact = key_time_lp.solve_exactly

    def counted(problem: KeyTimeProblem) -> Floats:
        times = problem.keys.requested_times.tolist()
        solved.append(len(times) * sum(1 for (i, j), gap in problem.gaps.items() if times[j] - times[i] < gap))
        return exact(problem)

    monkeypatch.setattr(key_time_lp, "solve_exactly", counted)
    nods = "".join(f'<head id="h{k}" lexeme="NOD" repetition="100" start="{0.5 * k}"/>' for k in range(60))
    made = plan_block(parse(f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{nods}</bml>'), known)
    assert max(solved, default=0) <= key_time_lp.MAX_PROGRAM_SIZE
    late = {notice.id for notice in made.notices}
    assert late >= {f"b:h{k}" for k in range(1, 60)}  # each is warned of, or left out by name
    assert {sync.behaviour for sync in made.syncs} == {f"h{k}" for k in range(60)}

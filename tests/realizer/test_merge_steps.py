"""Steps of the merge of a block with a running motion, on small motions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.bml.block import NoticeType
from kinesic.bml.parse import parse
from kinesic.motion.trajectory import Trajectory, stay
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.realizer import merge as module
from kinesic.realizer.merge import MergedMotion, _Attempt, _conflicts, _Merge, merge, replace_motion
from kinesic.realizer.occupancy import MergeFailure, Occupancy, occupancy_of

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
NOD = '<head id="n" lexeme="NOD" stroke="0"/>'
BEAT = '<gesture id="g" lexeme="beat" mode="RIGHT_HAND"/>'
SPOKEN = '<speech id="s"><text>Yes</text></speech>'
NECK = 3  # index of a neck hinge whose rest angle is 0
START = 50.0  # [s] clock time at which the running motion starts


@pytest.fixture(scope="module")
def planned(known):
    plans = {}
    return lambda text: plans.setdefault(text, plan_quickly(parse(ROOT.format(text)), known))


@pytest.fixture
def nod(planned):
    return planned(NOD)


@pytest.fixture
def rest(known):
    return stay(known.robot.skeleton.rest, start=START)


def use(id: str, *roles: str, begin=0.0, ready=0.1, relax=0.2, end=0.3, offset=None) -> Occupancy:
    return Occupancy(id, frozenset(roles), np.zeros(22, dtype=np.bool_), begin, ready, relax, end, offset)


def test_merged_motion_truncated_at_a_time_keeps_later_control_points_and_offsets():
    motion, layer = (Trajectory(np.arange(220.0).reshape(10, 22) * scale, 0.0) for scale in (1.0, 2.0))
    later = MergedMotion(motion, 0.5, layer, (), (), ("a",), ()).since(0.02)
    for part, whole in ((later.trajectory, motion), (later.layer, layer)):
        assert part.start == pytest.approx(0.02)
        np.testing.assert_array_equal(part.controls, whole.controls[2:])
    assert (later.zero, later.dropped) == (0.5, ("a",))


def test_only_blocks_without_speech_may_be_delayed_by_a_merge(planned, rest, monkeypatch):
    calls = []

    def merged(task, *, waits):
        calls.append((waits, task.cut, task.desired, task.others))
        return "a merged motion"

    monkeypatch.setattr(_Merge, "merged", merged)
    occupied = [use("a", "sign", relax=START + 9.0)]
    nod, spoken = planned(NOD), planned(SPOKEN + NOD)
    assert merge(rest, START + 0.1, nod, begin=START + 0.3, occupied=occupied) == "a merged motion"
    merge(rest, START + 0.1, spoken, begin=START + 0.3)
    replace_motion(rest, START + 0.1, spoken, begin=START + 0.3)
    replace_motion(rest, START + 0.1, nod)
    assert [waits for waits, *_ in calls] == [True, False, True, True]
    assert [cut for _, cut, *_ in calls] == [10] * 4
    zero = 0.1 + nod.trajectory.zero
    assert [desired for _, _, desired, _ in calls] == pytest.approx([0.3, 0.3, 0.3, zero])
    assert [[entry.behaviour for entry in others] for *_, others in calls] == [["a"], [], [], []]


def test_replaced_motion_releases_all_hinges(nod, rest, known, monkeypatch):
    calls = []
    monkeypatch.setattr(module, "release_motion", lambda *given: calls.append(given) or rest)
    replace_motion(rest, START + 0.1, nod)
    ((running, time, hinges, setup),) = calls
    assert (running, time, setup) == (rest, START + 0.1, known)
    assert hinges.all()


def test_merge_times_are_relative_to_the_start_of_the_running_motion(nod, rest):
    occupied = [
        use("a", "sign", relax=START + 0.21),
        use("b", "sign", relax=START + 0.199),
        use("c", "look", relax=99.0),
    ]
    task = _Merge.of(rest, START + 0.195, nod, occupied, START + 0.5)
    assert (task.running, task.coming, task.cut) == (rest, nod, 20)
    assert task.desired == pytest.approx(0.5)
    assert [(entry.behaviour, entry.relax) for entry in task.others] == [
        ("a", pytest.approx(0.21)),
        ("c", pytest.approx(49.0)),
    ]


@pytest.mark.parametrize(
    ("desired", "cut", "soonest"),
    [(0.3, 0, 30), (0.3, 29, 30), (0.3, 45, 45), (0.301, 0, 31), (0.3 + 1e-9, 0, 30), (-5.0, 7, 7)],
)
def test_block_motion_begins_at_the_first_knot_that_makes_its_start_no_earlier_than_desired(
    nod, rest, desired, cut, soonest
):
    later = SimpleNamespace(trajectory=replace(nod.trajectory, zero=0.25))
    assert _Merge(rest, nod, cut, (), desired + 0.25)._soonest(later) == soonest


@pytest.fixture
def tried(monkeypatch, nod, rest):
    """Record merge attempts, without conflicts from a delay [knots] on."""
    calls, free = [], [0]

    def attempt(_task, delay=0, *, whole=False):
        calls.append((delay, whole))
        return _Attempt(nod, delay, rest.controls, rest.controls, (), {} if delay >= free[0] else {"n": "busy"})

    monkeypatch.setattr(_Merge, "attempt", attempt)
    monkeypatch.setattr(_Merge, "_delays", [5, 15, 25])
    monkeypatch.setattr(_Merge, "result", lambda _task, attempt: attempt.offset)
    return calls, free


@pytest.mark.parametrize(
    ("waits", "free", "delay", "expected"),
    [
        (True, 0, 0, [(0, False)]),
        (True, 1, 5, [(0, False), (5, True)]),
        (True, 15, 15, [(0, False), (5, True), (15, True)]),
        (True, 99, 0, [(0, False), (5, True), (15, True), (25, True)]),
        (False, 5, 0, [(0, False)]),
    ],
)
def test_block_is_delayed_by_the_smallest_tried_delay_without_conflicts_or_not_at_all(
    tried, nod, rest, waits, free, delay, expected
):
    calls, first_free = tried
    first_free[0] = free
    assert _Merge(rest, nod, 0, (), 0.0).merged(waits=waits) == delay
    assert calls == expected


def test_tried_delays_include_the_end_of_each_conflict_except_with_held_postures(nod, rest):
    task = _Merge(rest, nod, 30, (), 0.0)
    ready = task.block_occupancy[0].ready + 0.3
    other = use("a", "sign", ready=ready - 1.0, relax=ready + 0.2)
    longer = replace(other, relax=ready + 0.304)
    held = replace(other, relax=ready + 0.5, offset=np.zeros(22))
    elsewhere = replace(other, roles=frozenset({"look"}), relax=ready + 0.5)
    assert replace(task, others=(other, longer, held, elsewhere))._delays == [31, 41, 51]
    assert replace(task, others=(other,))._delays == [20, 30, 40, 60]
    assert replace(task, others=(replace(other, relax=ready + 0.005),))._delays == [1, 11, 21, 41]
    assert replace(task, others=(held, elsewhere))._delays == [10, 20, 40]
    assert task._delays == [10, 20, 40]


def test_conflict_names_the_common_hands_and_the_remaining_time():
    both = use("g", "l_hand", "r_hand", "trunk", ready=1.0, relax=2.0)
    free = use("n", "sign", ready=1.0, relax=2.0)
    others = [use("past", "l_hand", relax=1.0), use("o", "r_hand", "l_hand", relax=1.5), use("p", "l_hand", relax=9.0)]
    assert _conflicts([both, free], others) == {"g": "l_hand and r_hand busy with o for 0.50 s more"}


def test_time_zero_of_a_block_counts_from_the_knot_at_which_its_motion_begins(nod):
    attempt = _Attempt(nod, 30, nod.trajectory.controls, nod.trajectory.controls, (), {})
    assert attempt.zero == pytest.approx(0.3 + nod.trajectory.zero)


@pytest.fixture
def outcome(nod, rest):
    """Return the result of a merge attempt with a late block zero [s]."""

    def of(*, late=0.0, neck=(), left_out=None, performed=(), others=(), base=rest.controls) -> MergedMotion:
        controls = np.tile(base[:1], (max(len(base), len(neck)), 1))
        controls[: len(neck), NECK] = neck
        attempt = _Attempt(nod, 30, base, controls, performed, left_out or {})
        return _Merge(rest, nod, 0, others, attempt.zero - late).result(attempt)

    return of


def test_merged_block_has_clock_times_and_joint_angles_relative_to_the_running_motion(outcome, rest, nod):
    merged = outcome(neck=[0.0] * 5 + [0.2] * 10 + [0.0] * 20, performed=[use("n", "sign", begin=0.4)])
    assert merged.trajectory.start == merged.layer.start == START
    assert len(merged.trajectory.controls) == 18
    assert len(merged.layer.controls) == 35
    expected = np.zeros((35, 22))
    expected[5:15, NECK] = 0.2
    np.testing.assert_array_equal(merged.layer.controls, expected)
    np.testing.assert_array_equal(merged.trajectory.controls, rest.controls[0] + expected[:18])
    assert merged.zero == pytest.approx(START + 0.3 + nod.trajectory.zero)
    assert [entry.begin for entry in merged.occupancy] == [START + 0.4]
    assert (merged.syncs, merged.dropped, merged.notices) == (tuple(nod.syncs), (), ())


def test_merge_without_changes_returns_the_running_motion_object(outcome, rest):
    base = np.tile(rest.controls[:1], (9, 1))
    assert outcome(base=base).trajectory is rest
    assert not outcome(base=base).layer.controls.any()


def test_behaviours_dropped_by_a_merge_have_no_times_and_cause_a_notice(outcome):
    merged = outcome(left_out={"n": "its hand is busy"})
    assert (merged.syncs, merged.dropped) == ((), ("n",))
    (notice,) = merged.notices
    assert (notice.type, notice.id) == (NoticeType.IMPOSSIBLE_TO_SCHEDULE, "b:n")
    assert notice.text == "left out: its hand is busy"


@pytest.mark.parametrize(("late", "is_reported"), [(SHIFT_TO_WARN - 1e-6, False), (SHIFT_TO_WARN + 1e-6, True)])
def test_block_later_than_the_warning_threshold_reports_only_its_delayed_stroke(outcome, late, is_reported):
    texts = [(notice.id, notice.text) for notice in outcome(late=late).notices]
    assert texts == [("b:n", "stroke is delayed by 0.010 s with the block")] * is_reported


def test_held_posture_that_is_not_reached_causes_a_notice(outcome):
    offset = 0.3 * np.eye(22)[NECK]
    merged = outcome(performed=[use("n", "look", offset=offset)], others=[use("o", "trunk", offset=offset)])
    assert [notice.id for notice in merged.notices] == ["b:n"]
    assert "ends 34 deg off its held posture" in merged.notices[0].text


def test_gaze_of_a_block_also_occupies_the_hinges_of_the_gaze_that_it_supersedes(outcome):
    neck = np.arange(22) == NECK
    held = replace(use("o", "look", offset=np.zeros(22)), hinges=neck)
    (entry,) = outcome(performed=[use("n", "look")], others=[held]).occupancy
    np.testing.assert_array_equal(entry.hinges, neck)


@pytest.fixture
def overlays(monkeypatch):
    """Record overlays of a merged block, the first ones with given failures."""
    works, failures, clashes = [], [], []

    def overlay_motions(work, _setup, _limits):
        works.append(work)
        return failures.pop(0) if failures else work.base + 0.5

    monkeypatch.setattr(module, "overlay_motions", overlay_motions)
    monkeypatch.setattr(module, "find_conflict", lambda *_: clashes.pop(0) if clashes else None)
    return works, failures, clashes


def test_merge_attempt_overlays_the_delayed_block_on_the_running_motion(overlays, nod, rest):
    others = (use("o", "look", relax=9.0),)
    task = _Merge(rest, nod, 7, others, nod.trajectory.zero + 0.3)
    attempt = task.attempt(12)
    (work,) = overlays[0]
    count = 42 + len(nod.trajectory.controls)
    assert (attempt.coming, attempt.offset, attempt.left_out) == (nod, 42, {})
    assert len(work.base) == len(work.coming) == count
    np.testing.assert_array_equal(work.coming[42:], nod.trajectory.controls)
    np.testing.assert_array_equal(work.start, nod.trajectory.controls[0])
    np.testing.assert_array_equal(work.base, np.tile(rest.controls[0], (count, 1)))
    assert (work.cut, work.holding) == (7, others)
    assert [entry.begin for entry in work.performed] == pytest.approx([occupancy_of(nod)[0].begin + 0.42])
    assert attempt.performed == work.performed
    assert attempt.base is work.base
    np.testing.assert_array_equal(attempt.controls, work.base + 0.5)
    assert task.attempt().offset == 30


def test_longer_running_motion_continues_after_the_block(overlays, nod, rest):
    longer = replace(rest, controls=np.tile(rest.controls[:1], (900, 1)))
    attempt = _Merge(longer, nod, 0, (), 1.0).attempt()
    assert len(attempt.controls) == len(overlays[0][0].coming) == 900


@pytest.mark.parametrize("whole", [False, True])
def test_conflicting_behaviour_is_dropped_and_the_rest_overlaid_unless_conflicts_end_the_attempt(
    overlays, planned, rest, whole
):
    plan = planned(NOD + BEAT)
    others = (use("o", "r_hand", ready=-1.0, relax=99.0),)
    attempt = _Merge(rest, plan, 0, others, 1.0).attempt(whole=whole)
    assert attempt.left_out.keys() == {"g"}
    assert "r_hand busy with o" in attempt.left_out["g"]
    assert len(overlays[0]) == (not whole)
    assert [entry.behaviour for entry in attempt.performed] == ["n"] * (not whole)
    assert (attempt.coming is plan) is whole
    assert (attempt.controls is attempt.base) is whole


def test_behaviour_that_cannot_be_overlaid_is_left_out_with_its_reason(overlays, planned, rest):
    works, failures, clashes = overlays
    failures.append(MergeFailure("g", "no time"))
    clashes.append(MergeFailure("n", "collides"))
    plan = planned(NOD + BEAT)
    attempt = _Merge(rest, plan, 0, (), 1.0).attempt()
    assert attempt.left_out == {"g": "no time", "n": "collides"}
    assert [{entry.behaviour for entry in work.performed} for work in works] == [{"g", "n"}, {"n"}]
    assert (attempt.coming, attempt.performed) == (plan, [])
    assert attempt.controls is attempt.base


def test_running_motion_is_unchanged_if_idle_motion_cannot_be_overlaid(overlays, planned, rest):
    _, failures, clashes = overlays
    idle = planned('<wait id="w" duration="1"/>')
    for cause in (failures, clashes):
        cause.append(MergeFailure("", "collides"))
        attempt = _Merge(rest, idle, 0, (), 0.0).attempt()
        assert (attempt.left_out, attempt.performed) == ({}, [])
        assert attempt.controls is attempt.base
    attempt = _Merge(rest, idle, 0, (), 0.0).attempt()
    assert attempt.controls is not attempt.base


def test_behaviour_dropped_by_the_second_plan_is_left_out_with_the_reason_of_the_plan(
    overlays, planned, rest, monkeypatch
):
    plan, nod = planned(NOD + BEAT), planned(NOD)
    outcomes = {**plan.keyframes.outcomes, "g": replace(plan.keyframes.outcomes["g"], why="no time left")}
    shorter = replace(nod, keyframes=replace(nod.keyframes, outcomes=outcomes))
    monkeypatch.setattr(module, "plan_without", lambda whole, left_out: shorter)
    attempt = _Merge(rest, plan, 0, (), 1.0).attempt()
    assert attempt.left_out == {"g": "no time left"}
    assert [entry.behaviour for entry in attempt.performed] == ["n"]

"""Sums of a block's motion and a running motion, and their limits."""

import numpy as np
import pytest

from kinesic.body.limits import Limits
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.motion.transition import SAME_ANGLE
from kinesic.realizer import overlay as module
from kinesic.realizer.held import HeldRamp
from kinesic.realizer.occupancy import MergeFailure, Occupancy, Overlay, arm_hinges
from kinesic.realizer.overlay import add_motions, overlay_motions

HINGE_COUNT = 22
ROW_COUNT = 40  # control points of the test motions
NECK = 3  # index of a neck hinge whose rest angle is 0
TORSO = 0  # index of a torso hinge whose rest angle is 0
NO_HINGES = np.zeros(HINGE_COUNT, dtype=np.bool_)
ALL_HINGES = ~NO_HINGES


@pytest.fixture
def limits():
    """Limits on jerk alone, in third differences [rad] of control points."""
    ones = np.ones(HINGE_COUNT)
    return Limits.box(
        lower=-1e6 * ones, upper=1e6 * ones, speed=1e9 * ones, acceleration=1e12 * ones, jerk=ones / KNOT_INTERVAL**3
    )


@pytest.fixture
def corrections(monkeypatch):
    """Record the corrections of hinges, which then leave the sum as it is."""
    calls = []

    def keep_limits(desired, first, last, _limits, hinge):
        calls.append((hinge, first, last))
        return desired

    monkeypatch.setattr(module, "keep_limits", keep_limits)
    return calls


def still() -> np.ndarray:
    return np.zeros((ROW_COUNT, HINGE_COUNT))


def jerky(jerks: dict[int, float]) -> np.ndarray:
    """Return a hinge's control points with third differences [rad] at given knots."""
    third = np.zeros(ROW_COUNT - 3)
    for knot, jerk in jerks.items():
        third[knot] = jerk
    return np.concatenate([np.zeros(3), np.cumsum(np.cumsum(np.cumsum(third)))])


def work(base, coming, *, cut=0, holding=(), performed=(), finishing=()) -> Overlay:
    return Overlay(base, coming, np.zeros(HINGE_COUNT), cut, holding, performed, finishing)


def use(id: str, *roles: str, begin=0.1) -> Occupancy:
    return Occupancy(id, frozenset(roles), ALL_HINGES, begin, begin + 0.1, begin + 0.2, begin + 0.3)


def test_summed_motion_adds_the_offsets_of_the_block_except_for_given_hinges(known, limits):
    base, coming = still(), still()
    base[:, [TORSO, NECK]] = 0.3
    coming[:, [TORSO, NECK]] = np.linspace(0.5, 0.6, ROW_COUNT)[:, None]
    start = np.full(HINGE_COUNT, 0.5)
    coming[:, 1:3] = coming[:, 4:] = 0.5
    total = add_motions(Overlay(base, coming, start, 0, (), ()), np.arange(HINGE_COUNT) == NECK, known, limits)
    np.testing.assert_allclose(total[:, TORSO], 0.3 + np.linspace(0.0, 0.1, ROW_COUNT))
    np.testing.assert_array_equal(total[:, NECK], 0.3)
    assert not np.delete(total, [TORSO, NECK], axis=1).any()


@pytest.mark.parametrize(("end", "count"), [(0.2, ROW_COUNT), (0.405, 41 + 6)])
def test_summed_motion_ends_six_knots_after_the_change_of_a_held_posture(known, limits, monkeypatch, end, count):
    ramps = [HeldRamp(np.full(HINGE_COUNT, turn), 0.1, end) for turn in (0.2, -0.05)]
    monkeypatch.setattr(module, "held_ramps", lambda *_: ramps)
    total = add_motions(work(still(), still()), NO_HINGES, known, limits)
    assert len(total) == count
    np.testing.assert_allclose(total, ramps[0].at(count, lead=3) + ramps[1].at(count, lead=3))


@pytest.mark.parametrize(
    ("rows", "cut", "corrected"),
    [
        (slice(20, 25), 0, [(17, 25)]),
        (slice(20, 25), 19, [(19, 25)]),
        (slice(20, 25), 22, [(22, 25)]),
        (slice(20, 25), 23, []),
        (slice(20, ROW_COUNT), 0, [(17, ROW_COUNT - 3)]),
    ],
)
def test_summed_motion_is_corrected_from_three_knots_before_its_change_to_the_end_of_it(
    known, limits, corrections, rows, cut, corrected
):
    coming = still()
    coming[rows, NECK] = np.tile([5.0, -5.0], ROW_COUNT)[: len(coming[rows])]
    total = add_motions(work(still(), coming, cut=cut), NO_HINGES, known, limits)
    np.testing.assert_array_equal(total, coming)
    assert corrections == [(NECK, first, last) for first, last in corrected]


@pytest.mark.parametrize(
    ("knot", "jerk", "is_over"), [(16, 1.5, False), (17, 0.9, True), (20, -0.9, True), (21, 1.5, False)]
)
def test_summed_motion_is_corrected_if_it_exceeds_limits_where_it_changes(
    known, limits, corrections, knot, jerk, is_over
):
    base, coming = still(), still()
    base[:, NECK] = jerky({knot: jerk})
    coming[20, NECK] = 0.15
    add_motions(work(base, coming), NO_HINGES, known, limits)
    assert corrections == [(NECK, 17, 21)] * is_over


def test_hinges_and_control_points_with_negligible_change_are_not_corrected(known, limits, corrections):
    base, coming = still(), still()
    base[:, NECK] = jerky({20: 1.5})
    base[:, TORSO] = jerky({30: 1.5})
    coming[20, NECK] = coming[33, TORSO] = SAME_ANGLE
    coming[20, TORSO] = 0.1
    total = add_motions(work(base, coming), NO_HINGES, known, limits)
    assert corrections == []
    np.testing.assert_allclose(total, base + coming, atol=1e-12)


def test_summed_motion_without_a_change_is_the_running_motion_even_beyond_limits(known, limits, corrections):
    base = still()
    base[:, NECK] = jerky({20: 1.5})
    np.testing.assert_array_equal(add_motions(work(base, still()), NO_HINGES, known, limits), base)
    assert corrections == []


def test_angles_beyond_the_range_are_clipped_before_the_correction(known, limits, monkeypatch):
    narrow = Limits(**{**vars(limits), "lower": -2.0 * np.ones(HINGE_COUNT), "upper": 3.0 * np.ones(HINGE_COUNT)})
    coming, desired = still(), {}
    coming[20:22, NECK] = 9.0, -9.0

    def keep_limits(controls, _first, _last, _limits, hinge):
        desired[hinge] = controls
        return controls + 0.5

    monkeypatch.setattr(module, "keep_limits", keep_limits)
    total = add_motions(work(still(), coming), NO_HINGES, known, narrow)
    assert desired.keys() == {NECK}
    np.testing.assert_array_equal(desired[NECK][19:23], [0.0, 3.0, -2.0, 0.0])
    np.testing.assert_array_equal(total[:, NECK], desired[NECK] + 0.5)


def test_summed_motion_that_cannot_be_corrected_names_the_last_trunk_behaviour(known, limits, monkeypatch):
    monkeypatch.setattr(module, "keep_limits", lambda *_: None)
    coming = still()
    coming[20, NECK] = 5.0
    performed = [use("nod", "sign"), use("beat", "r_hand")]
    failure = add_motions(work(still(), coming, performed=performed), NO_HINGES, known, limits)
    reason = f"{known.robot.skeleton.names[NECK]} cannot follow both motions within limits"
    assert failure == MergeFailure("nod", reason)


@pytest.fixture
def parts(monkeypatch):
    """Record hinges of the running motion, and arm hinges with their role."""
    alone, joined = [], []

    def add(work, hinges, _setup, _limits):
        alone.extend(np.flatnonzero(hinges).tolist())
        return np.array(work.base)

    def join(work, role, hinge, _limits):
        joined.append((role, hinge))
        return np.concatenate([work.base[:, hinge], [0.1] * 5])

    monkeypatch.setattr(module, "add_motions", add)
    monkeypatch.setattr(module, "join_hinge_motions", join)
    return alone, joined


@pytest.mark.parametrize(
    ("entries", "roles"),
    [
        ({}, ()),
        ({"holding": ["r_hand"]}, ("r_hand",)),
        ({"holding": ["look"]}, ()),
        ({"performed": ["sign"]}, ("l_hand", "r_hand")),
        ({"finishing": ["r_hand"]}, ("l_hand", "r_hand")),
    ],
)
def test_arm_motions_are_joined_instead_of_added_except_for_idle_motion_of_free_arms(
    known, limits, parts, entries, roles
):
    alone, joined = parts
    uses = {name: [use(role, role) for role in given] for name, given in entries.items()}
    whole = overlay_motions(work(still(), still(), **uses), known, limits)
    expected = [(role, hinge) for role in roles for hinge in arm_hinges(role, known.robot)]
    assert joined == expected
    assert alone == sorted(hinge for _, hinge in expected)
    arms = [hinge for _, hinge in expected]
    assert len(whole) == ROW_COUNT + (5 if arms else 0) + 1
    np.testing.assert_array_equal(whole[-6:, arms], 0.1)
    assert not np.delete(whole, arms, axis=1).any()


def test_trunk_failure_takes_precedence_over_a_hand_failure(known, limits, monkeypatch):
    first, second = MergeFailure("a", "sum"), MergeFailure("b", "hand")
    task = work(still(), still(), performed=[use("beat", "r_hand")])
    monkeypatch.setattr(module, "join_hinge_motions", lambda *_: second)
    assert overlay_motions(task, known, limits) is second
    monkeypatch.setattr(module, "add_motions", lambda *_: first)
    assert overlay_motions(task, known, limits) is first


@pytest.mark.parametrize(
    ("knot", "excess", "step", "fails"),
    [
        (10, 0.5e-6, 0.1, False),
        (10, 1.5e-6, 0.1, True),
        (9, 0.5, 0.1, False),
        (10, 0.5, SAME_ANGLE, False),
        (10, 0.5, 2 * SAME_ANGLE, True),
    ],
)
def test_changed_hinge_may_exceed_its_limits_only_by_rounding(known, limits, monkeypatch, knot, excess, step, fails):
    """Unchanged hinges, and control points before the cut, keep the running motion."""
    base = still()
    bump = {0: 1.0, 2: -0.5, 4: -0.5, 6: -0.5, 8: -0.5, 9: 0.5, 11: 0.5}  # from rest to rest
    base[:, NECK] = jerky({knot + later: (1.0 + excess) * jerk for later, jerk in bump.items()})
    base[:, TORSO] = jerky({20: 2.0})
    total = np.array(base)
    total[2, NECK] += step
    monkeypatch.setattr(module, "add_motions", lambda *_: total)
    result = overlay_motions(work(base, base, cut=10, performed=[]), known, limits)
    if fails:
        reason = f"{known.robot.skeleton.names[NECK]} cannot follow both motions within limits"
        assert result == MergeFailure("", reason)
    else:
        np.testing.assert_array_equal(result[:-1], total)

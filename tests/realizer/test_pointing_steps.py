"""Steps of the correction of a pointing hand, on small motions."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.planning.clearance import LAG_RESERVE
from kinesic.realizer import pointing as module
from kinesic.realizer.pointing import (
    PointingHand,
    PointingStroke,
    _is_feasible,
    correct_pointing,
    pointing_hands,
)

from .small_pointing import ARM, HINGE_COUNT, START, motion, use


@pytest.mark.parametrize(
    ("to_aim", "degrees"),
    [((0.0, 2.0, 0.0), 0.0), ((0.0, 1.0, 1.0), 45.0), ((3.0, 0.0, 0.0), 90.0), ((0.0, -1, 0.0), 180.0)],
)
def test_pointing_error_is_the_angle_at_the_wrist_between_the_palm_and_the_target(to_aim, degrees):
    """The hand is turned to the left, and its palm lies forward of the wrist."""
    turned = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    frames = SimpleNamespace(rotations={"wrist": turned}, origins={"wrist": np.array([1.0, 2.0, 3.0])})
    arms = {"r": SimpleNamespace(wrist="wrist", palm=SimpleNamespace(position=np.array([0.1, 0.0, 0.0])))}
    robot = SimpleNamespace(skeleton=SimpleNamespace(frames=lambda _angles: frames), arm=arms.get)
    hand = PointingHand("p", "r", None, np.array([1.0, 2.0, 3.0]) + to_aim)
    assert np.degrees(hand.miss(np.zeros(HINGE_COUNT), robot)) == pytest.approx(degrees, abs=1e-9)


def test_pointing_hands_are_those_that_aim_in_a_stroke_of_their_own_behaviour():
    aim = np.ones(3)
    right, left, free = SimpleNamespace(aim=aim), SimpleNamespace(aim=aim), SimpleNamespace(aim=None)
    frames = [
        SimpleNamespace(syncs=[("p", "ready"), ("p", "stroke")], hands={"r": right, "l": left}),
        SimpleNamespace(syncs=[("q", "stroke")], hands={"r": right, "l": free}),
        SimpleNamespace(syncs=[("q", "relax")], hands={"l": left}),
    ]
    uses = {"p": {"r_hand"}, "q": {"l_hand"}}
    (hand,) = pointing_hands(SimpleNamespace(keyframes=SimpleNamespace(frames=frames, uses=uses)))
    assert (hand.behaviour, hand.side, hand.hand, hand.aim) == ("p", "r", right, aim)


@pytest.fixture
def corrections(monkeypatch):
    """Record corrections and checked motions, of which some are infeasible."""
    columns, judged, failures = [], [], [0]

    def keep_limits(desired, first, last, _limits, hinge):
        columns.append((hinge, first, last, desired))
        return desired

    def is_feasible(controls, before, first, last, _setup):
        judged.append((controls, before, first, last))
        return len(judged) > failures[0]

    monkeypatch.setattr(module, "keep_limits", keep_limits)
    monkeypatch.setattr(module, "_is_feasible", is_feasible)
    return columns, judged, failures


def stroke(*, time=0.5, occupancy=None, change=0.1) -> PointingStroke:
    """Return a stroke whose arm must turn by an angle [rad]."""
    turn = change * (np.arange(HINGE_COUNT) == ARM)
    pointer = SimpleNamespace(behaviour="p", side="r", arm=lambda posture, _robot: posture + turn)
    return PointingStroke(pointer, START + time, (occupancy or use()).shifted(START))


def correct(known, *, time=0.1, others=(), count=100, angle=0.3, **options):
    others = [other.shifted(START) for other in others]
    return correct_pointing(motion(count, angle=angle, start=START), START + time, stroke(**options), others, known)


def test_pointing_correction_is_complete_from_the_stroke_to_its_relax_point(known, corrections):
    result = correct(known)
    columns, judged, _ = corrections
    ((hinge, first, last, desired),) = columns
    assert (hinge, first, last) == (ARM, 20, 83)
    change = (desired - 0.3) / 0.1
    np.testing.assert_allclose(change[:24], 0.0, atol=1e-9)
    np.testing.assert_allclose(change[50:64], 1.0)
    np.testing.assert_allclose(change[83:], 0.0, atol=1e-9)
    assert 0.0 < change[24] < 0.1
    assert 0.9 < change[49] < 1.0
    assert change[73] == pytest.approx(0.5)
    assert change[35:38] == pytest.approx([0.4, 0.465, 0.535], abs=0.1)
    assert (result.start, result.zero) == (START, 0.25)
    assert len(result.controls) == 86
    np.testing.assert_allclose(result.controls[:, ARM], desired[:86])
    np.testing.assert_array_equal(np.delete(result.controls, ARM, axis=1), 0.3)
    ((controls, before, first, last),) = judged
    assert len(controls) == 100
    assert (before.start, first, last) == (START, 20, 83)


@pytest.mark.parametrize(
    ("time", "others", "knots"),
    [
        (0.305, [], (31, 83)),
        (0.1, [use("o", ready=0.1, relax=0.3)], (30, 83)),
        (0.1, [use("o", ready=0.49, relax=0.3)], (30, 83)),
        (0.1, [use("o", ready=0.696, relax=0.9)], (20, 73)),
        (0.1, [use("o", ready=0.694, relax=0.9)], (20, 73)),
        (0.1, [use("o", ready=0.5, relax=0.9)], (20, 83)),
        (0.1, [use("o", "l_hand", ready=0.1, relax=0.3), use("n", "sign", ready=0.7)], (20, 83)),
    ],
)
def test_pointing_correction_stays_between_the_other_behaviours_of_the_hand(known, corrections, time, others, knots):
    correct(known, time=time, others=others)
    assert corrections[0][0][1:3] == knots


def test_pointing_correction_beyond_the_end_of_the_motion_extends_it(known, corrections):
    correct(known, count=70)
    ((controls, *_),) = corrections[1]
    assert len(controls) == 89


@pytest.mark.parametrize(("time", "is_tried"), [(0.8, True), (0.81, False)])
def test_pointing_correction_is_tried_only_up_to_the_end_of_the_behaviour(known, corrections, time, is_tried):
    result = correct(known, time=time)
    assert (result is not None) is is_tried
    assert bool(corrections[1]) is is_tried


@pytest.mark.parametrize(("failures", "factors"), [(0, [1.0]), (2, [1.0, 0.8, 0.5]), (3, [1.0, 0.8, 0.5])])
def test_infeasible_pointing_correction_is_reduced_at_most_twice(known, corrections, failures, factors):
    corrections[2][0] = failures
    result = correct(known)
    turns = [(desired[55] - 0.3) / 0.1 for *_, desired in corrections[0]]
    assert turns == pytest.approx(factors)
    assert (result is None) is (failures == 3)


def test_hinge_without_a_correction_within_limits_keeps_its_motion(known, corrections, monkeypatch):
    monkeypatch.setattr(module, "keep_limits", lambda *_: None)
    np.testing.assert_array_equal(correct(known).controls, 0.3)
    corrections[0].clear()
    correct(known, change=1e-9, angle=0.0)
    assert corrections[0] == []


@pytest.mark.parametrize(
    ("after", "before", "is_feasible"),
    [(0.9, 0.1, True), (1.0, 0.1, True), (1.01, 0.1, False), (1.2, 1.2, True), (1.3, 1.2, False)],
)
def test_pointing_correction_may_not_overload_a_drive_more_than_before(known, monkeypatch, after, before, is_feasible):
    peaks, seen = [], []

    def compute_peak_duties(trajectory, _setup):
        seen.append(trajectory.controls)
        return np.array([0.1, after if trajectory.controls[0, 0] else before])

    monkeypatch.setattr(module, "compute_peak_duties", compute_peak_duties)
    monkeypatch.setattr(
        module,
        "scan_clearance",
        lambda trajectory, _: peaks.append(trajectory.controls) or (None, SimpleNamespace(distances=np.ones(2))),
    )
    corrected, old = np.full((60, HINGE_COUNT), 0.5), motion(50)
    corrected[20, 0] = 0.7
    assert _is_feasible(corrected, old, 20, 40, known) is is_feasible
    np.testing.assert_array_equal(seen[0], corrected[20:43])
    np.testing.assert_array_equal(seen[1], np.zeros((23, HINGE_COUNT)))
    assert [len(controls) for controls in peaks] == [23] * is_feasible


@pytest.mark.parametrize(("spare", "is_feasible"), [(0.0, True), (-1e-9, False)])
def test_pointing_correction_is_feasible_if_its_smallest_distance_keeps_the_reserve(
    known, monkeypatch, spare, is_feasible
):
    distances = np.array([1.0, known.robot.min_clearance + LAG_RESERVE + spare])
    monkeypatch.setattr(module, "compute_peak_duties", lambda *_: np.zeros(2))
    monkeypatch.setattr(module, "scan_clearance", lambda *_: (None, SimpleNamespace(distances=distances)))
    assert _is_feasible(np.zeros((60, HINGE_COUNT)), motion(50), 20, 40, known) is is_feasible

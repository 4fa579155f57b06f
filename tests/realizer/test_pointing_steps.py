"""Steps of the correction of a pointing hand, on small motions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.bml.composition import BlockState
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.clearance import LAG_RESERVE
from kinesic.planning.syncs import SyncTime
from kinesic.realizer import pointing as module
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import Occupancy
from kinesic.realizer.pointing import (
    PointingHand,
    PointingStroke,
    _is_feasible,
    _reference_miss,
    _restore_hand,
    _with_motion,
    correct_pointing,
    pointing_hands,
    restore_pointing,
)
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene

HINGE_COUNT = 22
ARM = 9  # a hinge of the right arm
NO_HINGES = np.zeros(HINGE_COUNT, dtype=np.bool_)
START = 50.0  # [s] clock time at which the running motion starts
TOLERANCE = np.radians(2.0)  # [rad] accepted increase of the pointing error


def motion(count: int = 100, *, angle: float = 0.0, start: float = 0.0) -> Trajectory:
    return Trajectory(np.full((count, HINGE_COUNT), angle), 0.25, start)


def use(id: str = "p", *roles: str, begin=0.2, ready=0.4, relax=0.6, end=0.8) -> Occupancy:
    return Occupancy(id, frozenset(roles or ("r_hand",)), NO_HINGES, begin, ready, relax, end)


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


def test_hands_point_only_in_their_own_strokes_at_a_target():
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
    """Record corrected columns with their knots, and judged motions; so many of them are not feasible."""
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


def test_correction_is_complete_from_the_stroke_to_its_relax_point(known, corrections):
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
def test_correction_stays_between_the_other_behaviours_of_the_hand(known, corrections, time, others, knots):
    correct(known, time=time, others=others)
    assert corrections[0][0][1:3] == knots


def test_correction_beyond_the_end_of_the_motion_extends_it(known, corrections):
    correct(known, count=70)
    ((controls, *_),) = corrections[1]
    assert len(controls) == 89


@pytest.mark.parametrize(("time", "is_tried"), [(0.8, True), (0.81, False)])
def test_correction_needs_three_knots(known, corrections, time, is_tried):
    result = correct(known, time=time)
    assert (result is not None) is is_tried
    assert bool(corrections[1]) is is_tried


@pytest.mark.parametrize(("failures", "factors"), [(0, [1.0]), (2, [1.0, 0.8, 0.5]), (3, [1.0, 0.8, 0.5])])
def test_correction_that_is_not_feasible_is_reduced(known, corrections, failures, factors):
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
def test_correction_may_not_overload_a_drive_more_than_before(known, monkeypatch, after, before, is_feasible):
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
def test_nearest_distance_of_a_correction_counts(known, monkeypatch, spare, is_feasible):
    distances = np.array([1.0, known.robot.min_clearance + LAG_RESERVE + spare])
    monkeypatch.setattr(module, "compute_peak_duties", lambda *_: np.zeros(2))
    monkeypatch.setattr(module, "scan_clearance", lambda *_: (None, SimpleNamespace(distances=distances)))
    assert _is_feasible(np.zeros((60, HINGE_COUNT)), motion(50), 20, 40, known) is is_feasible


def test_all_hands_of_playing_blocks_are_checked_after_a_change_of_the_motion(monkeypatch):
    calls = []
    monkeypatch.setattr(module, "pointing_hands", lambda plan: plan)
    monkeypatch.setattr(
        module, "_restore_hand", lambda *given: calls.append(given) or SimpleNamespace(calls=len(calls))
    )
    blocks = [SimpleNamespace(id=id, prepared=SimpleNamespace(plan=hands)) for id, hands in (("a", "pq"), ("b", "r"))]
    before, scene = SimpleNamespace(motion=motion()), SimpleNamespace(motion=motion(), playing=blocks)
    assert restore_pointing(before, scene, 2.0).calls == 3
    assert [(call[0], *call[2:]) for call in calls] == [
        (before, "a", "p", 2.0),
        (before, "a", "q", 2.0),
        (before, "b", "r", 2.0),
    ]
    same = SimpleNamespace(motion=before.motion, playing=blocks)
    assert restore_pointing(before, same, 2.0) is same
    assert len(calls) == 3


class Stage:
    """Scene with one block, whose pointing error [rad] depends on its motion."""

    def __init__(self, misses: dict[str, float], **changes) -> None:
        self.misses, self.motion, self.warnings = misses, "bent", []
        self.setup = SimpleNamespace(robot="robot")
        running = {"occupancy": (use(), use("q")), "merged": "merged", "zero": 4.0, "times": {"p": {"stroke": 0.5}}}
        self.running = SimpleNamespace(**{**running, "warning": lambda notice, now: (notice, now), **changes})

    def find(self, id: str):
        return self.running if id == "a" else None

    def first_change(self, now: float) -> float:
        return now + 1.0

    def occupancy_without(self, block: str):
        return (f"others than {block}",)

    def with_feedback(self, warning):
        self.warnings.append(warning)
        return self


@pytest.fixture
def restored(monkeypatch):
    """Restore a hand of a block with pointing errors [rad] in the motions `bent` and `corrected`."""
    calls = []

    def restore(*, usual=0.0, bent=1.0, corrected=0.0, now=2.0, block="a", result="corrected", **changes):
        stage = Stage({"bent": bent, "corrected": corrected}, **changes)

        def correct(*given):
            calls.append(given)
            return result

        def miss(_stroke, where, robot):
            assert robot == "robot"
            return stage.misses[where]

        def with_motion(scene, _running, behaviour, where):
            assert behaviour == "p"
            scene.motion = where
            return scene

        monkeypatch.setattr(module, "correct_pointing", correct)
        monkeypatch.setattr(module.PointingStroke, "miss", miss)
        monkeypatch.setattr(module, "_reference_miss", lambda before, *_: {"before": usual}[before])
        monkeypatch.setattr(module, "_with_motion", with_motion)
        pointer = PointingHand("p", "r", None, np.zeros(3))
        assert _restore_hand("before", stage, block, pointer, now) is stage
        return stage, calls

    return restore


def test_hand_that_misses_its_target_is_corrected(restored):
    stage, ((where, change, stroke, others, setup),) = restored()
    assert (where, change, setup) == ("bent", 3.0, stage.setup)
    assert (stroke.time, stroke.occupancy, stroke.pointer.behaviour) == (4.5, stage.running.occupancy[0], "p")
    assert others == ["others than a", stage.running.occupancy[1]]
    assert (stage.motion, stage.warnings) == ("corrected", [])


@pytest.mark.parametrize(
    ("changes", "is_tried"),
    [
        ({"bent": 0.5 + 0.99 * TOLERANCE, "usual": 0.5}, False),
        ({"bent": 0.5 + 1.01 * TOLERANCE, "usual": 0.5}, True),
        ({"bent": TOLERANCE}, False),
        ({"now": 3.5}, False),
        ({"now": 3.49}, True),
        ({"merged": None}, False),
        ({"occupancy": (use("q"),)}, False),
        ({"block": "unknown"}, False),
    ],
)
def test_only_future_strokes_that_miss_more_than_usual_are_corrected(restored, changes, is_tried):
    stage, calls = restored(**changes)
    assert len(calls) == is_tried
    assert stage.warnings == []


@pytest.mark.parametrize(
    ("changes", "motion", "error"),
    [
        ({"result": None}, "bent", 57),
        ({"corrected": 1.0}, "bent", 57),
        ({"corrected": 0.5}, "corrected", 29),
        ({"corrected": 0.5, "usual": 0.5 - 1.01 * TOLERANCE}, "corrected", 29),
        ({"corrected": 0.5, "usual": 0.5 - 0.99 * TOLERANCE}, "corrected", None),
        ({"corrected": TOLERANCE}, "corrected", None),
    ],
)
def test_remaining_pointing_error_is_reported(restored, changes, motion, error):
    stage, _ = restored(**changes)
    assert stage.motion == motion
    assert len(stage.warnings) == (error is not None)
    for notice, now in stage.warnings:
        assert (notice.id, now) == ("a:p", 2.0)
        assert notice.text == f"its hand points {error} deg off its target, because other blocks move the trunk"


@pytest.mark.parametrize(
    ("is_there", "is_merged", "is_same_plan", "expected"),
    [
        (True, True, True, "before"),
        (True, True, False, "plan"),
        (True, False, True, "plan"),
        (False, True, True, "plan"),
    ],
)
def test_pointing_error_before_a_change_is_that_of_the_scene_or_of_a_new_plan(
    is_there, is_merged, is_same_plan, expected
):
    plan = SimpleNamespace(
        trajectory=motion(angle=0.2),
        syncs=[SyncTime("p", "ready", 0.0, 9.0), SyncTime("q", "stroke", 0.0, 8.0), SyncTime("p", "stroke", 0.0, 0.1)],
    )
    old = SimpleNamespace(
        merged="merged" if is_merged else None, prepared=SimpleNamespace(plan=plan if is_same_plan else None)
    )
    before = SimpleNamespace(
        find=lambda id: old if is_there and id == "a" else None,
        motion=motion(angle=0.7),
        setup=SimpleNamespace(robot="robot"),
    )
    pointer = SimpleNamespace(behaviour="p", miss=lambda angles, robot: (angles[0], robot))
    stroke, times = PointingStroke(pointer, 0.9, use()), []
    for where in (plan.trajectory, before.motion):
        sample = where.sample
        vars(where)["sample"] = lambda at, sample=sample: times.extend(at.tolist()) or sample(at)
    running = SimpleNamespace(id="a", prepared=SimpleNamespace(plan=plan))
    angle, robot = _reference_miss(before, running, stroke)
    assert (angle, robot) == (pytest.approx(0.7 if expected == "before" else 0.2), "robot")
    assert times == pytest.approx([0.9 if expected == "before" else 0.35])


def test_correction_becomes_part_of_the_motion_of_its_behaviour(known):
    layer = motion(40, angle=0.1, start=START)
    merged = MergedMotion(motion(), 0.5, layer, (use("p"), use("q")), (), (), ())
    prepared = SimpleNamespace(plan=SimpleNamespace(timeline=SimpleNamespace(block=SimpleNamespace(id="a"))))
    running = RunningBlock(prepared, BlockState.IN_EXEC, 0.5, {}, {}, merged)
    scene = replace(Scene.of(known), motion=motion(50, angle=0.2), blocks=(running,))
    scene.motion.controls[:, 2] = 0.0
    corrected = motion(60, angle=0.2)
    corrected.controls[:, 2] = 0.0
    corrected.controls[:, ARM] += 0.05
    corrected.controls[:, 2] += 1e-9
    after = _with_motion(scene, running, "p", corrected)
    assert after.motion is corrected
    (block,) = after.blocks
    assert block.merged.trajectory is corrected
    expected = np.full((60, HINGE_COUNT), 0.1)
    expected[:, ARM] += 0.05
    np.testing.assert_allclose(block.merged.layer.controls, expected, atol=1e-8)
    assert block.merged.layer.start == START
    hinges = {entry.behaviour: np.flatnonzero(entry.hinges).tolist() for entry in block.merged.occupancy}
    assert hinges == {"p": [ARM], "q": []}
    alone = _with_motion(scene, replace(running, merged=None), "p", corrected)
    assert (alone.motion, alone.blocks) == (corrected, scene.blocks)

"""Corrections of pointing hands after a change of the motion, on small motions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.bml.composition import BlockState
from kinesic.planning.syncs import SyncTime
from kinesic.realizer import pointing as module
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.pointing import (
    PointingHand,
    PointingStroke,
    _reference_miss,
    _restore_hand,
    _with_motion,
    restore_pointing,
)
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene

from .small_pointing import ARM, HINGE_COUNT, START, TOLERANCE, motion, use


def test_pointing_error_of_all_hands_is_checked_after_a_change_of_the_motion(monkeypatch):
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
    """Correct a hand with given pointing errors [rad] of two motions."""
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


def test_pointing_hand_that_misses_its_target_is_corrected(restored):
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
def test_only_future_strokes_whose_pointing_error_has_increased_are_corrected(restored, changes, is_tried):
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
def test_pointing_error_is_compared_with_that_of_the_previous_motion_or_else_of_the_plan(
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


def test_pointing_correction_becomes_part_of_the_motion_of_its_behaviour(known):
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

"""What conditioning did, told per behaviour."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller.performance import Performance, Reference
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.conditioning import LOSS_TO_TELL, find_deviations, story


def with_plan(performance: Performance, **changes: object) -> Performance:
    plan = replace(performance.plan, **changes)
    return replace(performance, reference=replace(performance.reference, plan=plan))


def test_a_stroke_that_came_too_soon_is_told_with_its_limit_and_its_loss(hurried: Performance) -> None:
    chapters = {chapter.behaviour: chapter for chapter in story(hurried)}
    rushed = chapters["rushed"]
    hinges = hurried.plan.setup.robot.skeleton.names
    told = {sync for moved in rushed.moved for sync in moved.syncs}
    syncs = [sync for sync in hurried.plan.syncs if sync.behaviour == "rushed"]
    assert told == {sync.sync for sync in syncs if abs(sync.planned - sync.asked) > SHIFT_TO_WARN}
    assert all(moved.hinge in hinges and moved.quantity and moved.ratio > 1.0 for moved in rushed.moved)
    assert {loss.part for loss in rushed.losses} == {"r_hand"}
    assert all(loss.planned < loss.asked and loss.share > LOSS_TO_TELL for loss in rushed.losses)
    assert rushed.shift == pytest.approx(max(abs(sync.planned - sync.asked) for sync in syncs))


def test_nothing_moved_is_no_story(calm: Performance) -> None:
    assert story(calm) == ()


@pytest.mark.parametrize("share", [0.05, 0.5, 1.0])
def test_strokes_after_a_stop_are_no_loss_of_the_plan(calm: Performance, share: float) -> None:
    strokes = [sync.planned + calm.plan.trajectory.zero for sync in calm.plan.syncs if sync.sync == "strokeEnd"]
    count = int(calm.reference.times.searchsorted(share * max(strokes))) + 1
    stopped = Reference(calm.plan, calm.reference.times[:count], calm.reference.duties[:count])
    assert story(replace(calm, reference=stopped)) == ()


def test_sync_points_that_moved_together_are_one_line(calm: Performance) -> None:
    late = tuple(replace(sync, planned=sync.planned + 0.1) for sync in calm.plan.syncs)
    (chapter,) = story(with_plan(calm, syncs=late))
    (moved,) = chapter.moved
    assert moved.syncs == tuple(sync.sync for sync in late)
    assert (moved.milliseconds, moved.hinge) == (100, "")


def test_hinges_that_stray_are_named_the_worst_first(calm: Performance) -> None:
    names = calm.plan.setup.robot.skeleton.names
    lost = np.radians(np.r_[0.5, 3.0, 1.5, np.zeros(len(names) - 3)])
    motion = replace(calm.plan.motion, lost=lost)
    found = find_deviations(with_plan(calm, motion=motion))
    assert [(stray.hinge, pytest.approx(stray.degrees)) for stray in found] == [(names[1], 3.0), (names[2], 1.5)]

"""Report of behaviours changed to keep the motion within limits."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.metrics.conditioning import MIN_REPORTED_LOSS, find_deviations
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.reference import Reference
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime


def with_plan(performance: DryRun, **changes: object) -> DryRun:
    plan = replace(performance.plan, **changes)
    return replace(performance, reference=replace(performance.reference, plan=plan))


def test_rushed_stroke_is_reported_with_its_time_shifts_limiting_joints_and_amplitude_loss(hurried: DryRun) -> None:
    chapters = {chapter.behaviour: chapter for chapter in hurried.reference.changes}
    rushed = chapters["rushed"]
    hinges = hurried.plan.setup.robot.skeleton.names
    results = {sync for moved in rushed.moved for sync in moved.syncs}
    syncs = [sync for sync in hurried.plan.syncs if sync.behaviour == "rushed"]
    assert results == {sync.sync for sync in syncs if abs(sync.planned - sync.requested) > SHIFT_TO_WARN}
    assert all(moved.hinge in hinges and moved.quantity and moved.ratio > 1.0 for moved in rushed.moved)
    assert {loss.part for loss in rushed.losses} == {"r_hand"}
    assert all(loss.planned < loss.asked and loss.fraction > MIN_REPORTED_LOSS for loss in rushed.losses)
    assert rushed.shift == pytest.approx(max(abs(sync.planned - sync.requested) for sync in syncs))


def test_plan_without_deviations_reports_no_changed_behaviours(calm: DryRun) -> None:
    assert calm.reference.changes == ()


@pytest.mark.parametrize("share", [0.05, 0.5, 1.0])
def test_strokes_after_a_stop_are_not_reported_as_weakened(calm: DryRun, share: float) -> None:
    strokes = [sync.planned + calm.plan.trajectory.zero for sync in calm.plan.syncs if sync.sync == "strokeEnd"]
    count = int(calm.reference.times.searchsorted(share * max(strokes))) + 1
    stopped = Reference(calm.plan, calm.reference.times[:count], calm.reference.duties[:count])
    assert stopped.changes == ()


def test_equally_shifted_sync_points_of_a_behaviour_are_reported_together(calm: DryRun) -> None:
    late = tuple(replace(sync, planned=sync.planned + 0.1) for sync in calm.plan.syncs)
    (chapter,) = with_plan(calm, syncs=late).reference.changes
    (moved,) = chapter.moved
    assert moved.syncs == tuple(sync.sync for sync in late)
    assert (moved.milliseconds, moved.hinge) == (100, "")


def test_deviations_from_the_request_are_sorted_and_small_deviations_are_omitted(calm: DryRun) -> None:
    names = calm.plan.setup.robot.skeleton.names
    lost = np.radians(np.r_[0.5, 3.0, 1.5, np.zeros(len(names) - 3)])
    motion = replace(calm.plan.motion, rms_distances=lost)
    deviations = find_deviations(with_plan(calm, motion=motion).plan)
    assert [(stray.hinge, pytest.approx(stray.degrees)) for stray in deviations] == [(names[1], 3.0), (names[2], 1.5)]
    many = replace(calm.plan.motion, rms_distances=np.radians(2.0 + np.arange(len(names), dtype=float)))
    worst = find_deviations(with_plan(calm, motion=many).plan)
    assert [stray.hinge for stray in worst] == [names[-1], names[-2], names[-3]]


def test_shifted_behaviour_without_a_moving_part_has_no_weaker_stroke(calm: DryRun) -> None:
    late = SyncTime("spoken", "stroke", 1.0, 1.2), SyncTime("spoken", "end", 1.5, 1.7)
    (chapter,) = with_plan(calm, syncs=(*calm.plan.syncs, *late)).reference.changes
    assert (chapter.behaviour, chapter.losses) == ("spoken", ())
    assert chapter.shift == pytest.approx(0.2)

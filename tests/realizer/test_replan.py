"""Continuation of a running block with a new plan."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.expressivity.style.style import Style
from kinesic.motion.trajectory import stay
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer.merge import merge
from kinesic.realizer.occupancy import arm_hinges
from kinesic.realizer.release import release_motion
from kinesic.realizer.replan import replan

from ..passage import passage_text
from .certified import certified

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="c">{}</bml>'


@pytest.fixture(scope="module")
def block():
    return parse(passage_text(1))


@pytest.fixture(scope="module")
def playing(known, block):
    return merge(stay(known.robot.skeleton.rest), 0.0, plan_quickly(block, known), begin=0.2)


@pytest.fixture(scope="module")
def others(known, block):
    styles = {name: replace(known, style=Style.load(name)) for name in ("neutral", "joyful", "sad")}
    return {name: plan_block(block, setup) for name, setup in styles.items()}


def reached(motion, zero, plan, sync, hinges) -> float:
    """Return the distance [rad] to another plan's posture at a sync point."""
    wanted = plan.trajectory.at(plan.trajectory.zero + sync.planned).angles[hinges]
    return float(np.abs(motion.at(zero + sync.planned).angles[hinges] - wanted).max())


def test_running_block_reaches_the_strokes_of_its_refined_plan(known, playing, others):
    replanned = replan(playing.trajectory, 0.35, playing, others["neutral"])
    certified(replanned.trajectory, known, playing.trajectory, 0.35)
    hinges = list(arm_hinges("r_hand", known.robot))
    for sync in replanned.syncs:
        if sync.sync == "stroke" and sync.behaviour.startswith("g"):
            assert reached(replanned.trajectory, replanned.zero, others["neutral"], sync, hinges) < 1e-6
    moved = max(abs(sync.planned - sync.requested) for sync in replanned.syncs)
    assert moved <= max(abs(sync.planned - sync.requested) for sync in playing.syncs)
    end = np.linspace(6.0, 8.0, 20)
    np.testing.assert_allclose(
        replanned.trajectory.sample(end)[0], others["neutral"].trajectory.sample(end - 0.2)[0], atol=1e-6
    )


@pytest.mark.parametrize("time", [0.3, 1.3, 1.9, 2.6, 3.6, 4.7])
@pytest.mark.parametrize("style", ["joyful", "sad"])
def test_style_change_at_sampled_times_keeps_limits_and_moves_strokes_by_at_most_0_3_s(
    known, playing, others, time, style
):
    replanned = replan(playing.trajectory, time, playing, others[style])
    certified(replanned.trajectory, known, playing.trajectory, time)
    strokes = {(sync.behaviour, sync.sync): sync.planned for sync in playing.syncs}
    for sync in replanned.syncs:
        if sync.sync == "stroke":
            assert sync.planned == pytest.approx(strokes[sync.behaviour, "stroke"], abs=0.3)
    assert {sync.behaviour for sync in replanned.syncs} == {sync.behaviour for sync in playing.syncs}


def test_started_gesture_keeps_its_times_of_the_old_plan(known, playing, others):
    begun = next(need for need in playing.occupancy if need.behaviour == "g3")
    time = begun.ready + 0.25
    replanned = replan(playing.trajectory, time, playing, others["joyful"])
    kept = [sync for sync in playing.syncs if sync.behaviour == "g3"]
    assert [sync for sync in replanned.syncs if sync.behaviour == "g3"] == kept


def test_block_merged_later_still_reaches_its_stroke_after_a_replan(known, playing, others):
    nod = plan_quickly(parse(ROOT.format('<gesture id="late" lexeme="beat" mode="RIGHT_HAND"/>')), known)
    both = merge(playing.trajectory, 0.3, nod, begin=5.6, occupied=playing.occupancy)
    assert both.dropped == ()
    replanned = replan(both.trajectory, 0.4, playing, others["neutral"], others=both.occupancy)
    certified(replanned.trajectory, known, both.trajectory, 0.4)
    hinges = list(arm_hinges("r_hand", known.robot))
    (stroke,) = (sync for sync in both.syncs if sync.sync == "stroke")
    assert reached(replanned.trajectory, both.zero, nod, stroke, hinges) < 1e-6


def test_removing_a_restyled_block_returns_the_motion_to_rest(known, playing, others):
    replanned = replan(playing.trajectory, 1.3, playing, others["sad"])
    free = np.ptp(replanned.layer.controls, axis=0) > 0.0
    gone = release_motion(replanned.trajectory, 2.0, free, known, layer=replanned.layer)
    certified(gone, known, replanned.trajectory, 2.0)
    np.testing.assert_allclose(gone.controls[-1], known.robot.skeleton.rest, atol=1e-6)


def test_block_whose_new_plan_has_ended_returns_to_rest(known):
    long, short = (
        plan_quickly(parse(ROOT.format(f'<head id="n" lexeme="NOD" repetition="{count}"/>')), known) for count in (4, 1)
    )
    nodding = merge(stay(known.robot.skeleton.rest), 0.0, long, begin=0.0)
    time = short.trajectory.duration + 0.5
    assert time < nodding.occupancy[0].relax
    found = replan(nodding.trajectory, time, nodding, short)
    certified(found.trajectory, known, nodding.trajectory, time)
    np.testing.assert_allclose(found.trajectory.controls[-1], known.robot.skeleton.rest, atol=1e-6)
    assert found.trajectory.duration < nodding.trajectory.duration


def test_block_whose_new_plan_is_motionless_returns_to_rest(known, block):
    nod = parse(ROOT.format('<head id="n" lexeme="NOD" repetition="3"/>'))
    nodding = merge(stay(known.robot.skeleton.rest), 0.0, plan_block(nod, known), begin=0.0)
    still = plan_block(replace(nod, behaviours=()), known)
    replanned = replan(nodding.trajectory, 0.6, nodding, still)
    certified(replanned.trajectory, known, nodding.trajectory, 0.6)
    np.testing.assert_allclose(replanned.trajectory.controls[-1], known.robot.skeleton.rest, atol=1e-6)

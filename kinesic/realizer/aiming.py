"""Hands that point, when what other blocks do with the trunk has changed: they point again, or the sender is told."""

from dataclasses import replace

import numpy as np

from kinesic.bml.block import Notice, NoticeType
from kinesic.body.arrays import sealed
from kinesic.motion.trajectory import Trajectory
from kinesic.motion.transition import lengthened
from kinesic.realizer.busy import STILL
from kinesic.realizer.feedback import Due
from kinesic.realizer.pointing import Pointed, corrected, pointed
from kinesic.realizer.running_block import Staged
from kinesic.realizer.scene import Scene

ASTRAY = np.radians(2.0)  # by which a hand may point farther past its aim than without other blocks


def aimed_again(before: Scene, scene: Scene, now: float) -> tuple[Scene, tuple[Due, ...]]:
    """Has hands that point keep to it, where the motion was so changed that they miss by more than `ASTRAY`.

    Args:
        before: with the motion as it was; of a block that has just begun, or is improved, its own plan counts.
        scene: with the motion as it is.
        now: [s] global time.

    Returns:
        The scene in which arms are turned back to what they point at in strokes to come, and a warning for each that
        servos cannot turn so far, or not without coming too near to the body.
    """
    told: list[Due] = []
    for staged in scene.playing if scene.motion is not before.motion else ():
        for one in pointed(staged.ready.plan):
            scene, dues = _one(before, scene, staged.id, one, now)
            told += dues
    return scene, tuple(told)


def _one(before: Scene, scene: Scene, block: str, one: Pointed, now: float) -> tuple[Scene, tuple[Due, ...]]:
    staged = scene.find(block)
    busy = next((each for each in staged.busy if each.behaviour == one.behaviour), None) if staged else None
    if staged is None or staged.merged is None or busy is None:
        return scene, ()
    time = staged.zero + staged.times[one.behaviour]["stroke"]
    stroke, change = scene.performance(time), scene.first_change(now)
    usual = _usual(before, staged, one, time)
    if stroke <= change or _miss(scene.motion, stroke, one, scene) <= usual + ASTRAY:
        return scene, ()
    others = [*scene.busy_but(block), *(each for each in staged.busy if each is not busy)]
    found = corrected(scene.motion, change, one, stroke, busy, others, scene.facts)
    if found is not None and _miss(found, stroke, one, scene) < _miss(scene.motion, stroke, one, scene):
        scene = _with(scene, staged, one.behaviour, found)
    left = _miss(scene.motion, stroke, one, scene)
    if left <= usual + ASTRAY:
        return scene, ()
    text = f"its hand points {np.degrees(left):.0f} deg past its target: other blocks move the trunk meanwhile"
    notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block}:{one.behaviour}", text)
    return scene, (staged.warning(notice, now),)


def _usual(before: Scene, staged: Staged, one: Pointed, time: float) -> float:
    """By how much a hand pointed past its aim before, or does in its own plan [rad]."""
    earlier, plan = before.find(staged.id), staged.ready.plan
    if earlier is not None and earlier.merged is not None and earlier.ready.plan is plan:
        return _miss(before.motion, before.performance(time), one, before)
    asked = next(sync.planned for sync in plan.syncs if (sync.behaviour, sync.sync) == (one.behaviour, "stroke"))
    return _miss(plan.trajectory, plan.trajectory.zero + asked, one, before)


def _miss(motion: Trajectory, time: float, one: Pointed, scene: Scene) -> float:
    return one.miss(motion.sample(np.array([time]))[0][0], scene.facts.robot)


def _with(scene: Scene, staged: Staged, behaviour: str, motion: Trajectory) -> Scene:
    """The scene with another motion, whose difference is the behaviour's of a block."""
    if staged.merged is None:
        return replace(scene, motion=motion)
    layer = staged.merged.layer
    count = max(len(motion.controls), len(scene.motion.controls), len(layer.controls))
    own, was, after = (lengthened(each.controls, count) for each in (layer, scene.motion, motion))
    change = after - was
    moved = np.abs(change).max(axis=0) > STILL
    needs = [
        replace(each, hinges=each.hinges | moved) if each.behaviour == behaviour else each
        for each in staged.merged.busy
    ]
    merged = replace(
        staged.merged, trajectory=motion, layer=Trajectory(sealed(own + change), layer.zero), busy=tuple(needs)
    )
    return replace(scene, motion=motion).put(replace(staged, merged=merged))

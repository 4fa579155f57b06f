"""Idle motion between blocks: a layer over rest, which is taken back before anything else begins."""

from dataclasses import replace

import numpy as np

from kinesic.bml.composition import BlockState
from kinesic.realizer.merge import merge
from kinesic.realizer.release import release_motion
from kinesic.realizer.running_block import PreparedBlock, RunningBlock
from kinesic.realizer.scene import Scene


def begin_idle(scene: Scene, prepared: PreparedBlock, now: float) -> Scene:
    """Lays idle motion over a robot that has nothing to do; else, or where it is in the way, the scene stays as it is.

    Args:
        scene: at some time before.
        prepared: a block in which nothing is asked. It sends no feedback, and no other block waits for it.
        now: [s] global time.
    """
    time = scene.first_change(now)
    if scene.blocks or scene.motion.end > time or not prepared.moves:
        return scene
    merged = merge(scene.motion, time, prepared.plan, begin=time, occupied=scene.lasting)
    if merged.trajectory is scene.motion:
        return scene
    own = RunningBlock.of(prepared, BlockState.IN_EXEC, {})
    return replace(scene, motion=merged.trajectory, idle=replace(own, zero=merged.zero, merged=merged))


def end_idle(scene: Scene, now: float) -> Scene:
    """Takes idle motion back as soon as the motion may change, and as fast as the limits allow."""
    idle, time = scene.idle, scene.first_change(now)
    if idle is None or idle.merged is None:
        return scene
    still = replace(scene, idle=None)
    if scene.motion.end <= time:
        return still
    layer = idle.merged.layer
    moved = np.ptp(layer.controls, axis=0) > 0.0
    return replace(
        still, motion=release_motion(scene.motion, time, moved, scene.setup, layer=layer, others=scene.lasting)
    )

"""Idle motion between blocks: a layer over a robot at rest. A block that starts calls `end_idle` first."""

from dataclasses import replace

import numpy as np

from kinesic.bml.composition import BlockState
from kinesic.realizer.merge import merge
from kinesic.realizer.release import release_motion
from kinesic.realizer.running_block import PreparedBlock, RunningBlock
from kinesic.realizer.scene import Scene


def begin_idle(scene: Scene, prepared: PreparedBlock, now: float) -> Scene:
    """Lays the idle motion of a block over a robot that has nothing to do.

    The block is kept as `Scene.idle`, apart from those of clients: it sends no feedback, and none waits for it.

    Args:
        scene: as it was advanced to `now`.
        prepared: a block in which nothing is asked.
        now: [s] global time; the motion changes no sooner than `scene.first_change(now)`.

    Returns:
        The scene itself where a block plays or waits, the robot moves, the block has no motion, or that motion would
        come too near to the body in the posture that is held.
    """
    earliest = scene.first_change(now)
    if scene.blocks or scene.motion.end > earliest or not prepared.moves:
        return scene
    merged = merge(scene.motion, earliest, prepared.plan, begin=earliest, occupied=scene.lasting)
    if merged.trajectory is scene.motion:  # `merge` has left everything out
        return scene
    idle = RunningBlock.of(prepared, BlockState.IN_EXEC, {})
    return replace(scene, motion=merged.trajectory, idle=replace(idle, zero=merged.zero, merged=merged))


def end_idle(scene: Scene, now: float) -> Scene:
    """Takes idle motion back, so that the robot returns to rest as fast as its limits allow; what is held stays.

    Args:
        scene: with idle motion, or without: then it is returned as it is.
        now: [s] global time; the motion changes no sooner than `scene.first_change(now)`.
    """
    if scene.idle is None or scene.idle.merged is None:
        return scene
    earliest, after = scene.first_change(now), replace(scene, idle=None)
    if scene.motion.end <= earliest:
        return after
    layer = scene.idle.merged.layer  # begins and ends at nothing: a hinge that it moves varies in it
    moved = np.ptp(layer.controls, axis=0) > 0.0
    motion = release_motion(scene.motion, earliest, moved, scene.setup, layer=layer, others=scene.lasting)
    return replace(after, motion=motion)

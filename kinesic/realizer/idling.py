"""Idle motion between blocks, as a layer over a resting robot.

A block that starts must call `end_idle` first.
"""

from dataclasses import replace

import numpy as np

from kinesic.bml.composition import BlockState
from kinesic.realizer.merge import merge
from kinesic.realizer.release import release_motion
from kinesic.realizer.running_block import PreparedBlock, RunningBlock
from kinesic.realizer.scene import Scene


def begin_idle(scene: Scene, prepared: PreparedBlock, now: float) -> Scene:
    """Add the idle motion of a block to a resting robot.

    The block is kept as `Scene.idle`, apart from client blocks: it sends no feedback, and no block waits for it.

    Args:
        scene: scene, advanced to `now`.
        prepared: block without requested behaviours.
        now: global time [s]; the motion changes at `scene.first_change(now)` at the earliest.

    Returns:
        The unchanged scene if a block runs or waits, the robot moves without following people, the block has no
        motion, or its motion would collide in the held posture.
    """
    earliest = scene.first_change(now)
    is_moving = scene.motion.end > earliest and not scene.follows
    if scene.blocks or is_moving or not prepared.moves:
        return scene
    merged = merge(scene.motion, earliest, prepared.plan, begin=earliest, occupied=scene.lasting)
    if merged.trajectory is scene.motion:  # all behaviours were dropped
        return scene
    idle = RunningBlock.of(prepared, BlockState.IN_EXEC, {})
    return replace(scene, motion=merged.trajectory, idle=replace(idle, zero=merged.zero, merged=merged))


def end_idle(scene: Scene, now: float) -> Scene:
    """Remove idle motion: moved hinges return to rest or the held posture.

    Args:
        scene: scene with or without idle motion.
        now: global time [s]; the motion changes at `scene.first_change(now)` at the earliest.
    """
    if scene.idle is None or scene.idle.merged is None:
        return scene
    earliest, after = scene.first_change(now), replace(scene, idle=None)
    if scene.motion.end <= earliest:
        return after
    layer = scene.idle.merged.layer  # the layer is zero at both ends, so a moved hinge varies
    moved = np.ptp(layer.controls, axis=0) > 0.0
    motion = release_motion(scene.motion, earliest, moved, scene.setup, layer=layer, others=scene.lasting)
    return replace(after, motion=motion)

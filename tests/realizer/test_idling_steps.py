"""Begin and end of idle motion, with merges and releases that are only recorded."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.composition import BlockState
from kinesic.realizer import idling as module
from kinesic.realizer.idling import begin_idle, end_idle
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.scene import Scene

from .small_blocks import HINGE_COUNT, small_block, small_motion, use


@pytest.fixture
def scene(known) -> Scene:
    """Scene at rest after 4 s that holds a gaze."""
    held = use("z", "look", offset=np.zeros(HINGE_COUNT))
    return replace(Scene.of(known, ahead=0.25), motion=small_motion(), lasting=(held,))


@pytest.fixture
def merged(monkeypatch):
    """Result of the merge, and the arguments of each call."""
    calls, result = [], [MergedMotion(small_motion(angle=0.1), 4.5, small_motion(), (), (), (), ())]

    def merge(*given, **options):
        calls.append((*given, options))
        return result[-1]

    monkeypatch.setattr(module, "merge", merge)
    return calls, result


def test_idle_motion_is_merged_at_the_earliest_change_time(scene, merged):
    calls, (result,) = merged
    spell = small_block("i", {"n": {"start": 0.0}}).prepared
    after = begin_idle(scene, spell, 4.0)
    assert calls == [(scene.motion, 4.25, spell.plan, {"begin": 4.25, "occupied": scene.lasting})]
    assert after.motion is result.trajectory
    assert (after.idle.state, after.idle.waits) == (BlockState.IN_EXEC, {})
    assert (after.idle.zero, after.idle.merged, after.idle.prepared) == (4.5, result, spell)
    assert after.blocks == ()


@pytest.mark.parametrize(("now", "begins"), [(3.71, False), (3.72, True), (9.0, True)])
def test_idle_motion_begins_only_after_the_running_motion_has_ended(scene, merged, now, begins):
    assert (begin_idle(scene, small_block("i").prepared, now) is not scene) is begins


def test_idle_motion_without_effect_or_during_a_running_block_does_not_begin(scene, merged):
    assert begin_idle(scene, small_block("i", moves=False).prepared, 9.0) is scene
    busy = scene.with_block(small_block("a"))
    assert begin_idle(busy, small_block("i").prepared, 9.0) is busy
    assert merged[0] == []
    merged[1].append(replace(merged[1][0], trajectory=scene.motion))
    assert begin_idle(scene, small_block("i").prepared, 9.0) is scene


@pytest.fixture
def released(monkeypatch):
    calls = []

    def release(motion, at, hinges, setup, **options):
        calls.append((motion, at, np.flatnonzero(hinges).tolist(), setup, options))
        return small_motion(9)

    monkeypatch.setattr(module, "release_motion", release)
    return calls


def idling(scene: Scene) -> Scene:
    controls = np.zeros((400, HINGE_COUNT))
    controls[9, [2, 5]] = (0.1, -0.1)
    block = small_block("i", motion=small_motion())
    layer = replace(small_motion(), controls=controls)
    return replace(scene, idle=replace(block, merged=replace(block.merged, layer=layer)))


def test_end_of_idle_motion_releases_the_hinges_that_it_moves(scene, released):
    before = idling(scene)
    after = end_idle(before, 3.0)
    ((motion, at, hinges, setup, options),) = released
    assert (motion, at, hinges, setup) == (scene.motion, 3.25, [2, 5], scene.setup)
    assert options == {"layer": before.idle.merged.layer, "others": scene.lasting}
    assert after.idle is None
    assert len(after.motion.controls) == 9


@pytest.mark.parametrize(("now", "is_released"), [(3.7, True), (3.72, False), (9.0, False)])
def test_idle_motion_that_is_over_ends_without_a_change(scene, released, now, is_released):
    after = end_idle(idling(scene), now)
    assert after.idle is None
    assert (len(released) == 1) is is_released
    assert (after.motion is scene.motion) is not is_released


def test_ending_idle_motion_changes_nothing_while_no_idle_motion_runs(scene, released):
    assert end_idle(scene, 3.0) is scene
    still = replace(scene, idle=small_block("i"))
    assert end_idle(still, 3.0) is still
    assert released == []

"""Steps of early ends of blocks, on blocks made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.composition import BlockState
from kinesic.planning.syncs import SyncTime
from kinesic.realizer import ending as module
from kinesic.realizer.ending import end_behaviours, end_block, is_over, stop_block
from kinesic.realizer.feedback import ScheduledFeedback
from kinesic.realizer.held import HELD_POSTURE_TOLERANCE
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import arm_hinges
from kinesic.realizer.scene import Scene

from .small_blocks import HINGE_COUNT, small_block, small_motion, use
from .small_endings import NECK, playing


@pytest.fixture
def scene_of(known):
    """Return a scene that plays one block and has its agenda."""

    def of(block, *, ahead: float = 0.25) -> Scene:
        scene = Scene.of(known, ahead=ahead).with_block(block)
        other = ScheduledFeedback(11.0, "text", 9)
        return replace(scene, agenda=(*block.agenda(), other))

    return of


@pytest.fixture
def released(monkeypatch):
    """Record the arguments of each release of motion."""
    calls = []

    def release(motion, at, hinges, setup, **options):
        calls.append((motion, at, np.flatnonzero(hinges).tolist(), setup, options))
        return motion.since(0.0)

    monkeypatch.setattr(module, "release_motion", release)
    return calls


@pytest.mark.parametrize(("time", "expected"), [(13.9, False), (14.0, True), (15.0, True)])
def test_playing_block_counts_as_over_at_its_end(scene_of, time, expected):
    block = playing()
    assert is_over(scene_of(block), block, time) is expected


def test_waiting_block_has_not_ended_but_a_block_without_pending_feedback_has(scene_of):
    waiting = playing(state=BlockState.LURKING)
    assert not is_over(scene_of(waiting), waiting, 99.0)
    block = playing()
    assert is_over(replace(scene_of(block), agenda=()), block, 0.0)
    other_run = replace(block, run=4)
    assert is_over(scene_of(block), other_run, 0.0)


def progress(scene: Scene) -> list[tuple]:
    return [
        (item.time, item.content.behaviour, item.content.point)
        for item in scene.outgoing_feedback
        if not isinstance(item.content, str)
    ]


def test_interrupted_block_reports_its_sync_points_up_to_the_change_time_and_its_end(scene_of):
    block = playing()
    after = end_block(scene_of(block), block, 10.75, "no reason")
    assert progress(after) == [
        (10.0, None, "start"),
        (10.0, "g", "start"),
        (10.5, "n", "start"),
        (11.0, "g", "stroke"),
        (11.0, None, "end"),
    ]
    end = after.outgoing_feedback[-1].content
    assert (end.time, end.state) == (1.0, BlockState.INTERRUPTED)
    (ended,) = after.ended
    assert (ended.id, ended.state) == ("b", BlockState.INTERRUPTED)
    assert {point.behaviour: time for point, time in ended.points.items() if point.sync == "start"} == {
        "g": 10.0,
        "n": 10.5,
        "bml": 10.0,
    }
    assert not any(point.behaviour == "n" and point.sync == "end" for point in ended.points)
    assert [item.content for item in after.agenda] == ["text"]
    assert after.blocks == ()


def test_ended_block_keeps_only_sync_points_that_have_passed(scene_of):
    block = playing()
    (ended,) = end_block(scene_of(block), block, 10.0, "").ended
    assert {point.behaviour for point in ended.points} == {"g", "bml"}


@pytest.mark.parametrize("now", [13.75, 20.0])
def test_block_whose_end_precedes_the_change_time_ends_as_done(scene_of, now):
    block = playing()
    after = end_block(scene_of(block), block, now, "")
    assert after.ended[-1].state is BlockState.DONE
    assert after.outgoing_feedback == ()
    assert len(after.agenda) > 1


@pytest.mark.parametrize(
    ("state", "now", "is_revoked"),
    [
        (BlockState.LURKING, 12.0, True),
        (BlockState.IN_EXEC, 9.7, True),
        (BlockState.IN_EXEC, 9.75, False),
        (BlockState.SUBSIDING, 10.0, False),
    ],
)
def test_block_that_has_not_begun_ends_as_revoked(scene_of, state, now, is_revoked):
    block = playing(state=state)
    provisional = ScheduledFeedback(20.0, "warned", unless_improved="b")
    scene = scene_of(block)
    after = end_block(replace(scene, agenda=(*scene.agenda, provisional)), block, now, "another came")
    assert after.ended[-1].state is (BlockState.REVOKED if is_revoked else BlockState.INTERRUPTED)
    assert [item.content for item in after.agenda] == ["text"]
    if is_revoked:
        (warning,) = after.outgoing_feedback
        assert (warning.time, warning.sender) == (now, 5)
        assert "revoked before it began: another came" in warning.xml
        assert 'id="b"' in warning.xml


def test_block_whose_start_feedback_was_sent_ends_as_interrupted(scene_of):
    block = playing()
    scene = scene_of(block)
    later = replace(scene, agenda=tuple(item for item in scene.agenda if item.time > 10.0))
    after = end_block(later, block, 5.0, "")
    assert after.ended[-1].state is BlockState.INTERRUPTED


def test_block_interrupted_after_its_start_but_before_its_first_behaviour_ends_as_interrupted(scene_of):
    block = small_block("b", {"n": {"start": 0.5, "end": 1.0}}, zero=10.0, run=3)
    after = end_block(scene_of(block), block, 9.9, "")
    assert after.ended[-1].state is BlockState.INTERRUPTED


def test_motion_of_a_stopped_block_is_removed_from_the_change_time_on(scene_of, released):
    block = playing(NECK, 5)
    scene = scene_of(block)
    after = stop_block(scene, block, 11.0, "")
    ((motion, at, hinges, setup, options),) = released
    assert (motion, at, setup) == (scene.motion, 11.25, scene.setup)
    assert hinges == [NECK, 5]
    assert options["others"] == ()
    np.testing.assert_array_equal(options["layer"].controls, block.merged.layer.controls)
    assert after.motion is not scene.motion
    assert after.ended[-1].state is BlockState.INTERRUPTED


def test_block_without_motion_or_at_its_end_releases_no_hinges(scene_of, released):
    still = replace(playing(), merged=None)
    assert stop_block(scene_of(still), still, 11.0, "").ended[-1].state is BlockState.INTERRUPTED
    block = playing(NECK)
    assert stop_block(scene_of(block), block, 14.0, "").ended[-1].state is BlockState.DONE
    unmoved = playing()
    scene = scene_of(unmoved)
    assert stop_block(scene, unmoved, 11.0, "").motion is scene.motion
    assert released == []


@pytest.mark.parametrize(("share", "is_warned"), [(0.99, False), (1.01, True), (-1.01, True)])
def test_sender_is_warned_if_the_trunk_cannot_return_to_the_held_posture(scene_of, monkeypatch, share, is_warned):
    block = playing(NECK)
    scene = scene_of(block)
    left = small_motion(angle=0.0)
    controls = np.tile(scene.setup.robot.skeleton.rest, (400, 1))
    controls[:, NECK] += share * HELD_POSTURE_TOLERANCE
    monkeypatch.setattr(module, "release_motion", lambda *_, **__: replace(left, controls=controls))
    texts = [item for item in stop_block(scene, block, 11.0, "").outgoing_feedback if isinstance(item.content, str)]
    assert len(texts) == is_warned
    if is_warned:
        assert "the trunk stays 1 deg off the held posture" in texts[0].xml
        assert (texts[0].time, texts[0].sender) == (11.0, 5)


def test_stopped_block_leaves_a_shared_hinge_to_the_other_block(scene_of, released):
    """The hinges that both move keep the motion of the other block, so the layer is zero there."""
    block = playing(NECK, 5, occupancy=(use("n", "look", offset=np.ones(HINGE_COUNT), hinges=[NECK], end=20.0),))
    scene = replace(scene_of(block), lasting=(use("o", "look", end=30.0, offset=np.zeros(HINGE_COUNT)),))
    bent = np.tile(scene.setup.robot.skeleton.rest, (400, 1))
    bent[:, NECK] += 0.3
    scene = replace(scene, motion=replace(scene.motion, controls=bent))
    stop_block(scene, block, 11.0, "")
    ((_, _, hinges, _, options),) = released
    assert hinges == [NECK, 5]
    assert not options["layer"].controls[:, NECK].any()
    assert options["layer"].controls[:, 5].any()
    assert [entry.behaviour for entry in options["others"]] == ["o"]


def both(**options):
    """Return a block whose gesture and nod both move the neck."""
    entries = (
        use("g", "r_hand", hinges=[NECK, 12], begin=10.0, relax=12.5, end=13.0),
        use("n", "sign", hinges=[NECK], begin=10.5, end=14.0),
    )
    return playing(NECK, 12, occupancy=entries, **options)


@pytest.fixture
def replanned(monkeypatch):
    """Result of replanning, and the arguments of each call."""
    calls, result = [], []

    def replan(*given, **options):
        calls.append((*given, options))
        return result[0] if result else None

    monkeypatch.setattr(module, "replan", replan)
    return calls, result


def test_block_is_interrupted_when_its_last_behaviours_are_ended(scene_of, released, replanned):
    block = both()
    after = end_behaviours(scene_of(block), block, frozenset({"g", "n"}), 11.0)
    assert after.ended[-1].state is BlockState.INTERRUPTED


def test_ending_behaviours_of_a_block_that_is_over_changes_nothing(scene_of, released, replanned):
    block = both()
    scene = scene_of(block)
    assert end_behaviours(scene, block, frozenset({"g"}), 13.75) is scene
    assert end_behaviours(scene, block, frozenset({"g"}), 13.74) is not scene


def test_ended_behaviour_releases_the_hinges_that_it_alone_moves(scene_of, released, replanned):
    block = both()
    scene = scene_of(block)
    after = end_behaviours(scene, block, frozenset({"g"}), 11.0)
    ((motion, at, hinges, _, options),) = released
    assert (motion, at, hinges) == (scene.motion, 11.25, [12])
    assert [entry.behaviour for entry in options["others"]] == ["n"]
    (left,) = after.blocks
    assert list(left.times) == ["n"]
    assert [item.content.point for item in after.agenda if getattr(item.content, "behaviour", None) == "g"] == [
        "start",
        "stroke",
    ]
    assert [item.time for item in after.agenda if item.is_block_end] == [14.0]
    assert len(after.outgoing_feedback) == 1
    assert "predictionFeedback" in after.outgoing_feedback[0].xml
    assert after.outgoing_feedback[0].time == 11.0


def test_shared_trunk_hinge_is_replanned_with_the_remaining_behaviours(scene_of, released, replanned):
    calls, result = replanned
    block = both()
    scene = scene_of(block)
    moved = small_motion(angle=0.5)
    other_layer = small_motion(angle=0.2)
    result.append(MergedMotion(moved, 10.0, other_layer, (), (SyncTime("n", "end", 0.0, 4.5),), (), ()))
    after = end_behaviours(scene, block, frozenset({"g"}), 11.0)
    ((running, change, merged, plan, options),) = calls
    assert (running, change, plan) == (scene.motion, 11.25, block.prepared.plan)
    assert [entry.behaviour for entry in merged.occupancy] == ["n"]
    assert options == {"others": ()}
    ((motion, at, hinges, _, options),) = released
    assert (motion, at, hinges, options["layer"]) == (moved, 11.25, [12], other_layer)
    assert [entry.behaviour for entry in options["others"]] == ["n"]
    (left,) = after.blocks
    assert left.times == {"n": {"end": 4.5}}
    assert left.merged is result[0]
    assert [item.time for item in after.agenda if item.is_block_end] == [14.5]


def test_only_arm_hinges_are_released_if_the_trunk_is_replanned(known, scene_of, released, replanned):
    """The replanned motion contains the trunk hinges already."""
    arm = arm_hinges("r_hand", known.robot)[0]
    entries = (
        use("g", "r_hand", hinges=[0, NECK, arm], begin=10.0, relax=12.5, end=13.0),
        use("n", "sign", hinges=[NECK], begin=10.5, end=14.0),
    )
    block = playing(NECK, arm, occupancy=entries)
    replanned[1].append(MergedMotion(small_motion(), 10.0, small_motion(), (), (), (), ()))
    end_behaviours(scene_of(block), block, frozenset({"g"}), 11.0)
    assert released[0][2] == [arm]


@pytest.mark.parametrize(
    ("ended", "is_replanned"),
    [
        (use("g", "r_hand", hinges=[NECK], end=11.3), True),
        (use("g", "r_hand", hinges=[NECK], end=11.25), False),
        (use("g", "look", hinges=[NECK], end=11.0, offset=np.zeros(HINGE_COUNT)), True),
        (use("g", "r_hand", hinges=[NECK + 1], end=13.0), False),
        (use("g", "r_hand", hinges=[12], end=13.0), False),
    ],
)
def test_trunk_is_replanned_only_while_the_ended_behaviour_uses_it(scene_of, released, replanned, ended, is_replanned):
    block = playing(NECK, occupancy=(ended, use("n", "sign", hinges=[NECK, 12], begin=10.5, end=14.0)))
    end_behaviours(scene_of(block), block, frozenset({"g"}), 11.0)
    assert len(replanned[0]) == is_replanned


def test_trunk_is_replanned_if_one_of_the_ended_behaviours_uses_it(scene_of, released, replanned):
    past, coming = (use(id, "r_hand", hinges=[NECK], end=end) for id, end in (("g", 11.0), ("k", 13.0)))
    block = playing(NECK, occupancy=(past, coming, use("n", "sign", hinges=[NECK], begin=10.5, end=14.0)))
    end_behaviours(scene_of(block), block, frozenset({"g", "k"}), 11.0)
    assert len(replanned[0]) == 1


def test_behaviour_of_a_motionless_block_ends_without_a_change_of_motion(scene_of, released, replanned):
    block = replace(playing(), merged=None)
    scene = scene_of(block)
    after = end_behaviours(scene, block, frozenset({"g"}), 11.0)
    assert after.motion is scene.motion
    assert list(after.find("b").times) == ["n"]
    assert released == replanned[0] == []

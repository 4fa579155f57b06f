"""Steps of a block's start, with stubbed merges."""

from dataclasses import replace

import pytest

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.composition import BlockState
from kinesic.body.utterance import Utterance
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.realizer import starting as module
from kinesic.realizer.feedback import ScheduledFeedback
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.scene import Scene
from kinesic.realizer.starting import activate_block, start_block

from .small_blocks import small_block, small_motion, use

NOD = '<head id="n" lexeme="NOD"/>'
TIMES = {"n": {"start": -0.5, "end": 2.0}}
NOTICE = Notice(NoticeType.CANNOT_CREATE_BEHAVIOR, "b:n", "moved to the left hand")


@pytest.fixture
def scene(known) -> Scene:
    return replace(Scene.of(known, ahead=0.25), motion=small_motion())


@pytest.fixture
def merged(monkeypatch):
    """Result of both stubbed merges, with name and arguments of each call."""
    motion, syncs = small_motion(angle=0.1), (SyncTime("n", "start", 0.0, -0.5), SyncTime("n", "end", 0.0, 2.0))
    calls, result = [], [MergedMotion(motion, 10.75, small_motion(), (use("n", "sign"),), syncs, (), (NOTICE,))]

    def step(name):
        def take(*given, **options):
            calls.append((name, *given, options))
            return result[-1]

        return take

    for name in ("merge", "replace_motion"):
        monkeypatch.setattr(module, name, step(name))
    return calls, result


def coming(id="b", times=None, *, attributes="", inside=NOD, state=BlockState.LURKING, **options):
    return small_block(
        id, TIMES if times is None else times, inside=inside, attributes=attributes, state=state, run=3, **options
    )


def texts(scene: Scene) -> list[str]:
    return [item.xml for item in scene.outgoing_feedback]


def test_started_block_is_merged_with_the_motion_of_running_blocks(scene, merged):
    busy = scene.with_block(small_block("a", motion=small_motion(), occupancy=[use("g", "l_hand")]))
    running = coming()
    after = start_block(busy.with_block(running), running, 10.0)
    ((name, motion, change, plan, options),) = merged[0]
    assert (name, motion, change, plan) == ("merge", scene.motion, 10.25, running.prepared.plan)
    assert options["begin"] == 10.75
    assert [entry.behaviour for entry in options["occupied"]] == ["a:g"]
    started = after.find("b")
    assert (started.state, started.zero) == (BlockState.IN_EXEC, 10.75)
    assert started.merged.trajectory is merged[1][0].trajectory
    assert [entry.behaviour for entry in started.occupancy] == ["n"]
    assert started.times == TIMES
    assert started.predicted == (10.75, TIMES)
    assert after.motion is merged[1][0].trajectory
    assert [active.id for active in after.blocks] == ["a", "b"]
    assert [(item.time, item.content.point) for item in after.agenda] == [
        (10.25, "start"),
        (10.25, "start"),
        (12.75, "end"),
        (12.75, "relax"),
        (12.75, "end"),
    ]


def test_prediction_feedback_precedes_the_notices_of_the_merge(scene, merged):
    prediction, warning = texts(start_block(scene, coming(), 10.0))
    assert "predictionFeedback" in prediction
    assert "moved to the left hand" in warning
    assert {item.time for item in start_block(scene, coming(), 10.0).outgoing_feedback} == {10.0}


@pytest.mark.parametrize(("shift", "is_told"), [(0.9 * SHIFT_TO_WARN, False), (1.1 * SHIFT_TO_WARN, True)])
def test_prediction_feedback_is_repeated_only_if_times_changed_by_more_than_a_threshold(scene, merged, shift, is_told):
    running = replace(coming(), predicted=(10.75 + shift, TIMES))
    found = texts(start_block(scene, running, 10.0))
    assert any("predictionFeedback" in text for text in found) is is_told


@pytest.mark.parametrize(
    ("is_anchored", "zero", "desired"), [(False, 20.0, 10.75), (True, 20.0, 20.0), (True, 5.0, 10.25)]
)
def test_block_with_references_begins_at_its_fixed_time_but_not_before_the_change_time(
    scene, merged, is_anchored, zero, desired
):
    start_block(scene, coming(is_anchored=is_anchored, zero=zero), 10.0)
    assert merged[0][0][4]["begin"] == desired


def test_waiting_block_begins_at_the_relax_point_of_its_dependency(scene, merged):
    other = small_block("a", {"h": {"start": 0.0, "relax": 1.0, "end": 2.0}}, zero=12.0)
    start_block(scene.with_block(other), coming(waits={"a": "relax"}), 10.0)
    assert merged[0][0][4]["begin"] == 13.5


@pytest.mark.parametrize("late", [0.5, 2 * SHIFT_TO_WARN, -0.5, 0.9 * SHIFT_TO_WARN])
@pytest.mark.parametrize("is_anchored", [True, False])
def test_block_that_begins_too_late_for_its_references_causes_a_warning(scene, merged, late, is_anchored):
    found = texts(start_block(scene, coming(is_anchored=is_anchored, zero=10.75 - late), 10.0))
    warnings = [text for text in found if "too late" in text]
    assert len(warnings) == (is_anchored and late > SHIFT_TO_WARN)
    if warnings:
        assert f"it begins {late:.3f} s too late for its references to other blocks" in warnings[0]


def test_motionless_block_changes_no_motion(scene, merged):
    running = coming(moves=False)
    after = start_block(scene, running, 10.0)
    assert merged[0] == []
    assert after.motion is scene.motion
    assert (after.find("b").zero, after.find("b").merged) == (10.75, None)
    replacing = coming(moves=False, attributes='composition="REPLACE"')
    assert start_block(scene, replacing, 10.0).motion is scene.motion
    assert merged[0] == []


@pytest.fixture
def ends(monkeypatch):
    """Names of the blocks that are stopped or ended, with the reason."""
    calls = []

    def end(name):
        def take(scene, other, now, why):
            calls.append((name, other.id, now, why))
            return scene.without_block(other, BlockState.INTERRUPTED)

        return take

    for name in ("stop_block", "end_block"):
        monkeypatch.setattr(module, name, end(name))
    return calls


@pytest.fixture
def crowd(scene) -> Scene:
    states = {"a": BlockState.IN_EXEC, "w": BlockState.LURKING, "p": BlockState.PENDING}
    return replace(scene, blocks=tuple(small_block(id, state=state) for id, state in states.items()), lasting=(use(),))


@pytest.mark.parametrize(("moves", "step"), [(True, "end_block"), (False, "stop_block")])
def test_replacing_block_ends_all_but_preplanned_blocks(crowd, merged, ends, moves, step):
    after = start_block(crowd, coming(attributes='composition="REPLACE"', moves=moves), 10.0)
    assert ends == [(step, "a", 10.0, "b replaces it"), (step, "w", 10.0, "b replaces it")]
    assert [active.id for active in after.blocks] == ["p", "b"]
    if moves:
        ((name, *given, options),) = merged[0]
        assert given == [crowd.motion, 10.25, after.find("b").prepared.plan]
        assert (name, options) == ("replace_motion", {"begin": 10.75})
        assert after.motion is merged[1][0].trajectory
    assert after.lasting == (() if moves else crowd.lasting)


def test_block_stops_the_blocks_that_it_interrupts(crowd, merged, ends):
    after = start_block(crowd, coming(attributes='bmla:interrupt="a,gone,b"'), 10.0)
    assert ends == [("stop_block", "a", 10.0, "b interrupts it")]
    assert after.find("w") is not None
    assert after.lasting == crowd.lasting


def test_block_whose_required_behaviour_was_dropped_fails(crowd, merged, ends):
    merged[1].append(replace(merged[1][0], syncs=(SyncTime("h", "end", 0.0, 1.0),)))
    inside = f'<required>{NOD}<head id="h" lexeme="NOD"/></required><head id="k" lexeme="NOD"/>'
    times = {id: {"start": 0.0, "end": 1.0} for id in "nhk"}
    running = coming(times=times, inside=inside, attributes='bmla:interrupt="a"')
    provisional = ScheduledFeedback(20.0, "warned", unless_improved="b")
    kept = ScheduledFeedback(20.0, "kept")
    before = replace(crowd, agenda=(*running.agenda(), provisional, kept))
    after = start_block(before, running, 10.0)
    assert after.motion is crowd.motion
    assert after.find("a") is not None
    assert after.ended[-1].state is BlockState.FAILED
    assert after.agenda == (kept,)
    notice, refusal = texts(after)
    assert "moved to the left hand" in notice
    assert "not performed, because it requires n<" in refusal
    assert 'id="b"' in refusal


def test_block_whose_optional_behaviour_was_dropped_is_performed(scene, merged):
    inside = f'<required>{NOD}</required><head id="k" lexeme="NOD"/>'
    running = coming(times={"n": {"end": 1.0}, "k": {"end": 1.0}}, inside=inside)
    assert start_block(scene, running, 10.0).find("b").state is BlockState.IN_EXEC


def test_overlapping_speech_is_dropped_with_a_notice(scene, merged):
    speech = '<speech id="s"><text>Yes</text></speech>'
    said = {"s": Utterance(5.0)}
    merged[1].append(replace(merged[1][0], syncs=(SyncTime("s", "start", 0.0, 0.0),)))
    busy = scene.with_block(small_block("a", {"s": {"start": 0.0}}, inside=speech, utterances=said, zero=9.0))
    after = start_block(busy, coming(times={"s": {"start": 0.0}}, inside=speech, utterances=said), 10.0)
    assert after.find("b").times == {}
    assert sum("a:s speaks until 14.00 s" in text for text in texts(after)) == 1


def test_started_block_activates_preplanned_blocks(crowd, merged):
    after = start_block(crowd, coming(attributes='bmla:onStart="p,w,gone"'), 10.0)
    assert after.find("p").state is BlockState.IN_EXEC
    assert after.find("w").state is BlockState.LURKING


def test_activated_block_waits_for_its_dependencies(scene, merged):
    other = small_block("a", {"h": {"start": 0.0, "end": 2.0}}, zero=20.0)
    waiting = coming("p", state=BlockState.PENDING, waits={"a": "end"})
    after = activate_block(scene.with_block(other).with_block(waiting), "p", 10.0)
    assert after.find("p").state is BlockState.LURKING
    assert merged[0] == []
    assert activate_block(scene.with_block(waiting), "p", 10.0).find("p").state is BlockState.IN_EXEC


def test_activation_starts_only_preplanned_blocks(crowd):
    for id in ("a", "w", "gone"):
        assert activate_block(crowd, id, 10.0) is crowd


def test_idle_motion_ends_before_a_block_starts(scene, merged, monkeypatch):
    quiet = replace(scene, motion=small_motion(9))
    monkeypatch.setattr(module, "end_idle", lambda scene, now: quiet if now == 10.0 else scene)
    start_block(scene, coming(), 10.0)
    assert merged[0][0][1] is quiet.motion


def test_pointing_hands_are_corrected_after_the_merge(scene, merged, monkeypatch):
    calls = []

    def restore(before, after, now):
        calls.append((before.motion, before.find("b").state, after.motion, now))
        return replace(after, runs=77)

    monkeypatch.setattr(module, "restore_pointing", restore)
    assert start_block(scene, coming(), 10.0).runs == 77
    assert calls == [(scene.motion, BlockState.LURKING, merged[1][0].trajectory, 10.0)]

"""Begin, advance and commands of a scene, with stubbed block starts."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.composition import BlockState
from kinesic.realizer import realizer as module
from kinesic.realizer.feedback import ScheduledFeedback
from kinesic.realizer.realizer import advance, begin, interrupt, stop_all_blocks
from kinesic.realizer.scene import Scene

from .small_blocks import small_block, small_motion

TIMES = {"n": {"start": -0.5, "end": 2.0}}
NOD = '<head id="n" lexeme="NOD"/>'


@pytest.fixture
def scene(known) -> Scene:
    return Scene.of(known, ahead=0.25)


@pytest.fixture
def steps(monkeypatch):
    """Record starts and ends of blocks by name."""
    calls = []

    def start(scene, running, now):
        calls.append(("start", running.id, now))
        return scene.with_block(replace(running, state=BlockState.IN_EXEC))

    def end(name):
        def take(scene, running, *given, yields=False):
            calls.append((name, running.id, *given, *(["yields"] if yields else [])))
            return scene.without_block(running, BlockState.INTERRUPTED)

        return take

    def other(name):
        def take(scene, *given):
            calls.append((name, *(getattr(item, "id", item) for item in given)))
            return scene

        return take

    monkeypatch.setattr(module, "start_block", start)
    for name in ("stop_block", "end_block"):
        monkeypatch.setattr(module, name, end(name))
    for name in ("end_behaviours", "activate_block", "change_parameter", "end_idle"):
        monkeypatch.setattr(module, name, other(name))
    monkeypatch.setattr(module, "restore_pointing", lambda before, after, now: after)
    return calls


def texts(scene: Scene) -> list[str]:
    return [item.xml for item in scene.outgoing_feedback]


def test_new_block_starts_at_once_without_dependencies(scene, steps):
    after = begin(scene, small_block("b", TIMES, inside=NOD).prepared, 10.0)
    assert steps == [("start", "b", 10.0)]
    started = after.find("b")
    assert (started.zero, started.run, started.state) == (10.75, 1, BlockState.IN_EXEC)
    assert begin(after, small_block("c", TIMES).prepared, 10.0).find("c").run == 2


def test_dependent_block_waits_and_is_predicted(scene, steps):
    busy = scene.with_block(small_block("a", TIMES, zero=20.0))
    after = begin(busy, small_block("b", TIMES, attributes='composition="APPEND"').prepared, 10.0)
    waiting = after.find("b")
    assert steps == []
    assert (waiting.state, waiting.waits, waiting.zero) == (BlockState.LURKING, {"a": "end"}, 22.5)
    assert waiting.predicted == (22.5, TIMES)
    (prediction,) = texts(after)
    assert 'globalStart="22.0"' in prediction
    assert after.outgoing_feedback[0].time == 10.0


def test_preplanned_block_waits_for_its_activation(scene, steps):
    after = begin(scene, small_block("b", TIMES, attributes='bmla:preplan="true"').prepared, 10.0)
    assert after.find("b").state is BlockState.PENDING
    assert steps == []


def test_provisional_notices_are_sent_one_second_later_unless_the_plan_is_refined(scene, steps):
    known, late = (Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "b", text) for text in ("known", "late"))
    block = small_block("b", TIMES, notices=(known, late), quick_notices=(known,), is_provisional=True)
    after = begin(scene, block.prepared, 10.0)
    assert [text.count("known") for text in texts(after)] == [1]
    assert [(item.time, item.unless_improved) for item in after.agenda] == [(11.0, "b")]
    (request,) = after.replans
    assert (request.block.id, request.is_decided) == ("b", True)
    full = begin(scene, replace(block.prepared, is_provisional=False), 10.0)
    assert len(texts(full)) == 2
    assert (full.replans, full.agenda) == ((), ())


@pytest.mark.parametrize(("state", "word"), [(BlockState.IN_EXEC, "plays"), (BlockState.LURKING, "waits")])
def test_block_with_a_used_id_is_refused_with_the_state_of_the_other_block(scene, steps, state, word):
    busy = scene.with_block(small_block("b", TIMES, state=state, waits={"p": "end"}))
    busy = busy.with_block(small_block("p", state=BlockState.PENDING))
    after = begin(busy, small_block("b", TIMES, sender=6).prepared, 10.0)
    (message,) = after.outgoing_feedback
    assert f"a block of this id {word} already ({state.value})" in message.xml
    assert (message.time, message.sender) == (10.0, 6)
    assert steps == []


@pytest.mark.parametrize(
    ("performer", "attributes", "inside", "refusal"),
    [
        (None, 'characterId="Bert"', NOD, None),
        ("Anna", "", NOD, None),
        ("Anna", 'characterId="Anna"', NOD, None),
        ("Anna", 'characterId="Bert"', NOD, None),
        ("Anna", 'characterId="Bert"', "", "it is for Bert, and Anna performs here"),
        ("Anna", "", "", None),
    ],
)
def test_empty_block_is_refused_only_if_it_is_for_another_character(
    scene, steps, performer, attributes, inside, refusal
):
    named = replace(scene, setup=replace(scene.setup, character=performer))
    found = texts(begin(named, small_block("b", inside=inside, attributes=attributes).prepared, 10.0))
    assert [text for text in found if "performs here" in text] == [text for text in found if refusal]
    assert (steps == []) == (refusal is not None)
    if refusal is not None:
        assert refusal in found[0]


def agents(*names):
    """Return a block whose behaviours are for some agents."""
    block = small_block("b", TIMES, inside="".join(NOD.replace('"n"', f'"n{k}"') for k in range(len(names))))
    wanted = tuple(
        replace(behaviour, agent=name) for behaviour, name in zip(block.block.behaviours, names, strict=True)
    )
    timeline = SimpleNamespace(block=replace(block.block, behaviours=wanted))
    plan = SimpleNamespace(**{**vars(block.prepared.plan), "timeline": timeline})
    return replace(block.prepared, plan=plan)


@pytest.mark.parametrize(
    ("names", "refusal"),
    [
        (("Bert",), "it is for Bert, and"),
        (("Bert", "Cleo", "Bert"), "it is for Bert and Cleo, and"),
        (("Bert", None), None),
    ],
)
def test_refusal_of_a_block_for_other_characters_names_the_agents_of_its_behaviours(scene, steps, names, refusal):
    named = replace(scene, setup=replace(scene.setup, character="Anna"))
    found = texts(begin(named, agents(*names), 10.0))
    assert any("performs here" in text for text in found) == (refusal is not None)
    if refusal is not None:
        assert refusal in found[0]


@pytest.mark.parametrize(("count", "is_refused"), [(255, False), (256, True)])
def test_block_beyond_256_others_is_refused(scene, steps, count, is_refused):
    block = small_block("a")
    full = replace(scene, blocks=(block,) * count)
    found = texts(begin(full, small_block("b").prepared, 10.0))
    assert any("256 blocks play and wait already" in text for text in found) is is_refused


def test_new_block_delays_a_waiting_block_that_it_names_unless_both_would_wait_for_each_other(scene, steps):
    first = small_block("a", TIMES, state=BlockState.PENDING)
    busy = scene.with_block(first)
    after = begin(busy, small_block("b", TIMES, attributes='bmla:chunkBefore="a"').prepared, 10.0)
    assert after.find("a").waits == {"b": "relax"}
    cyclic = small_block("b", TIMES, attributes='composition="APPEND-AFTER(a)" bmla:chunkBefore="a"')
    assert begin(busy, cyclic.prepared, 10.0).find("a").waits == {}
    waiting = scene.with_block(replace(first, waits={"z": "end"}))
    after = begin(waiting, small_block("b", TIMES, attributes='bmla:chunkBefore="a"').prepared, 10.0)
    assert after.find("a").waits == {"z": "end", "b": "relax"}


def test_scene_sends_due_messages_in_order_and_removes_them(scene):
    messages = tuple(ScheduledFeedback(time, f"t{time}") for time in (1.0, 2.0, 3.0))
    after = advance(replace(scene, agenda=messages).with_feedback(ScheduledFeedback(0.0, "old")), 2.0)
    assert after.outgoing_feedback == messages[:2]
    assert after.agenda == messages[2:]


def test_waiting_block_starts_before_due_messages_are_sent(scene, steps):
    waiting = small_block("w", state=BlockState.LURKING)
    busy = replace(scene.with_block(waiting), agenda=(ScheduledFeedback(1.0, "due"),))
    after = advance(busy, 1.0)
    assert steps == [("start", "w", 1.0)]
    assert texts(after) == ["due"]


def test_passed_sync_points_change_the_state_of_their_block(scene):
    block = small_block("b", {"n": {"start": 0.0, "relax": 1.0, "end": 2.0}}, inside=NOD, zero=10.0, run=3)
    playing = replace(scene.with_block(block), agenda=block.agenda())
    assert advance(playing, 10.9).find("b").state is BlockState.IN_EXEC
    assert advance(playing, 11.0).find("b").state is BlockState.SUBSIDING
    after = advance(playing, 12.0)
    assert (after.find("b"), after.ended[-1].state) == (None, BlockState.DONE)
    other_run = replace(playing, blocks=(replace(block, run=4),))
    assert advance(other_run, 12.0).find("b").state is BlockState.IN_EXEC


def commanding(command: str, target: str = "a"):
    """Return a block whose command is due at 10 s."""
    return small_block("b", {"i": {"start": 0.0, "end": 9.0}}, inside=command.format(target), zero=10.0, run=3)


INTERRUPT = '<bmla:interrupt id="i" target="{}"/>'
ACTIVATE = '<bmla:activate id="i" target="{}"/>'


def commanded(scene: Scene, block) -> Scene:
    playing = scene.with_block(small_block("a", {"g": {}, "h": {}})).with_block(block)
    return replace(playing, agenda=block.agenda())


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        (INTERRUPT, ("stop_block", "a", 10.0, "b interrupts it")),
        (INTERRUPT.replace("/>", ' include="g"/>'), ("end_behaviours", "a", frozenset({"g"}), 10.0)),
        (INTERRUPT.replace("/>", ' exclude="g"/>'), ("end_behaviours", "a", frozenset({"h"}), 10.0)),
        (ACTIVATE, ("activate_block", "a", 10.0)),
    ],
)
def test_bml_command_is_executed_at_its_start_time(scene, steps, command, expected):
    playing = commanded(scene, commanding(command))
    assert steps == []
    advance(playing, 9.9)
    assert steps == []
    advance(playing, 10.0)
    assert steps == [expected]


def test_activate_command_that_names_a_behaviour_activates_its_block(scene, steps):
    playing = commanded(scene, commanding(ACTIVATE, "a:g"))
    advance(playing, 10.0)
    assert steps == [("activate_block", "a", 10.0)]


@pytest.mark.parametrize("command", [INTERRUPT, ACTIVATE])
def test_command_to_a_missing_block_causes_a_warning(scene, steps, command):
    after = advance(commanded(scene, commanding(command, "gone")), 10.0)
    warnings = [item for item in after.outgoing_feedback if "warningFeedback" in item.xml]
    assert steps == []
    assert len(warnings) == 1
    assert 'id="b:i"' in warnings[0].xml
    assert "no block gone plays or waits" in warnings[0].xml
    assert (warnings[0].time, warnings[0].sender) == (10.0, 5)


@pytest.mark.parametrize(("block", "stopped"), [(None, ["a", "b"]), ("b", ["b"]), ("gone", [])])
def test_interruption_stops_one_block_or_all_blocks_and_idle_motion(scene, steps, block, stopped):
    busy = scene.with_block(small_block("a")).with_block(small_block("b"))
    after = interrupt(busy, 10.0, block, yields=True)
    expected = [("stop_block", id, 10.0, "it was interrupted", "yields") for id in stopped]
    assert steps == expected + [("end_idle", 10.0)] * (block is None)
    assert [active.id for active in after.blocks] == [id for id in "ab" if id not in stopped]


def test_emergency_stop_ends_all_blocks_and_keeps_other_scheduled_feedback(scene, steps):
    block = small_block("a", TIMES, zero=20.0, run=3)
    text, motion = ScheduledFeedback(30.0, "text"), small_motion()
    busy = replace(scene.with_block(block), agenda=(*block.agenda(), text), idle=small_block("i"))
    after = stop_all_blocks(busy, 10.0, motion)
    assert steps == [("end_block", "a", 10.0, "it was interrupted")]
    assert (after.motion, after.idle, after.agenda, after.ahead) == (motion, None, (text,), 0.0)

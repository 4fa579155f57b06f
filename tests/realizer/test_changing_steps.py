"""Steps of plan changes of active blocks."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from kinesic.bml.block import Notice, NoticeType, ParameterChange
from kinesic.bml.composition import BlockState
from kinesic.bml.parse import parse
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.realizer import changing as module
from kinesic.realizer.changing import (
    _announce,
    _has_equal_speech,
    _parameter_change,
    change_parameter,
    change_style,
    improve_block,
    take_replans,
)
from kinesic.realizer.feedback import ScheduledFeedback, times_by_behaviour
from kinesic.realizer.realizer import begin, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.realizer.scene import Scene

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
NOD = '<head id="h" lexeme="NOD"/>'


@pytest.fixture(scope="module")
def scene(known: Setup) -> Scene:
    """Scene in which block `a` plays."""
    empty = Scene.of(known, ahead=0.3)
    request = read_request(Message(ROOT.format("a", NOD)), known, context=empty.context(0.0))
    return begin(empty, prepare_block(request, known), 0.0)


@pytest.fixture
def running(scene):
    return scene.find("a")


@pytest.fixture
def better(running):
    """Another plan of the block with a later stroke."""
    return replace(running.prepared.plan, seconds=9.0, syncs=(SyncTime("h", "stroke", 0.5, 0.77),))


@pytest.fixture
def steps(monkeypatch, running):
    """Results of each stubbed step of a plan change, with its arguments."""
    merged = replace(running.merged, syncs=(SyncTime("h", "stroke", 0.5, 0.66), SyncTime("gone", "end", 0.5, 0.7)))
    results = {"replan": merged, "is_over": False}
    given = {}

    def step(name):
        def take(*arguments, **options):
            given[name] = (*arguments, *options.values())
            return results[name]

        return take

    def restore(before, after, now):
        given["restore_pointing"] = (before, after, now)
        return after.with_feedback(ScheduledFeedback(now, "points elsewhere", 0))

    for name in results:
        monkeypatch.setattr(module, name, step(name))
    monkeypatch.setattr(module, "restore_pointing", restore)
    return results, given


def test_plan_of_an_unknown_or_ended_block_is_not_changed(scene, better, steps):
    assert improve_block(scene, "b", better, 0.5) is None
    results, given = steps
    results["is_over"] = True
    assert improve_block(scene, "a", better, 0.5) is None
    assert given["is_over"] == (scene, scene.find("a"), 0.8)


def test_waiting_block_takes_its_new_plan_and_times(scene, running, better, steps):
    waiting = replace(running, state=BlockState.LURKING, prepared=replace(running.prepared, is_provisional=True))
    after = improve_block(scene.with_block(waiting), "a", better, 0.5).find("a")
    assert after.prepared.plan is better
    assert after.prepared.request is running.prepared.request
    assert not after.prepared.is_provisional
    assert after.times == {"h": {"stroke": 0.77}}
    assert "replan" not in steps[1]


def test_running_block_without_motion_or_with_changed_speech_is_not_replanned(
    scene, running, better, steps, monkeypatch
):
    assert improve_block(scene.with_block(replace(running, merged=None)), "a", better, 0.5) is None
    monkeypatch.setattr(module, "_has_equal_speech", lambda *plans: plans != (better, running.prepared.plan))
    assert improve_block(scene, "a", better, 0.5) is None
    assert "replan" not in steps[1]


def test_block_whose_motion_cannot_join_the_new_plan_keeps_its_plan(scene, better, steps):
    steps[0]["replan"] = None
    assert improve_block(scene, "a", better, 0.5) is None


def test_running_block_takes_its_new_plan_but_keeps_its_speech(scene, running, better, steps):
    results, given = steps
    waiting = (ScheduledFeedback(0.1, "to be sent", 0),)
    before = replace(scene, outgoing_feedback=waiting)
    after = improve_block(before, "a", replace(better, utterances={}), 0.3)
    motion, change, merged, plan, others = given["replan"]
    assert (motion, change, merged) == (scene.motion, 0.6, running.merged)
    assert plan.utterances is running.prepared.plan.utterances
    assert plan.seconds == 9.0
    assert others == before.occupancy_without("a")
    block = after.find("a")
    assert block.prepared.plan is plan
    assert block.prepared.request is running.prepared.request
    assert block.merged is results["replan"]
    assert block.times == {"h": {"stroke": 0.66}}
    assert after.motion is results["replan"].trajectory
    assert given["restore_pointing"][0] is before
    assert given["restore_pointing"][2] == 0.3
    assert after.outgoing_feedback == waiting
    assert waiting[0] not in after.agenda
    warning, *others = [message.xml for message in after.agenda if message.time == 0.3]
    assert warning == "points elsewhere"
    assert any("<predictionFeedback" in text for text in others)
    assert [message.time for message in after.agenda] == sorted(message.time for message in after.agenda)
    (stroke,) = [message.time for message in after.agenda if getattr(message.content, "point", "") == "stroke"]
    assert stroke == pytest.approx(running.zero + 0.66)


def test_speech_with_another_duration_mark_or_id_is_not_equal():
    def plan(duration: float, id: str = "s", **marks: float):
        return SimpleNamespace(utterances={id: SimpleNamespace(duration=duration, marks=marks)})

    assert _has_equal_speech(plan(1.0, m=0.5), plan(1.0, m=0.5))
    for other in (plan(1.1, m=0.5), plan(1.0, m=0.4), plan(1.0), plan(1.0, id="t", m=0.5)):
        assert not _has_equal_speech(plan(1.0, m=0.5), other)


@pytest.mark.parametrize("amount", [0.0, 1.0])
def test_movement_amount_of_all_blocks_may_be_zero_or_one(scene, amount):
    stale = replace(scene, outgoing_feedback=(ScheduledFeedback(0.1, "sent", 0),))
    after = change_style(stale, 0.2, amount=amount)
    (request,) = after.replans
    (behaviour,) = request.block.behaviours
    assert (behaviour.action.amount, behaviour.manner.style) == (amount, None)
    assert request.is_decided
    assert after.outgoing_feedback == ()
    assert after.setup is scene.setup
    assert change_style(scene, 0.2, amount=amount, block="b").replans == ()


@pytest.mark.parametrize("amount", [-0.01, 1.01])
def test_movement_amount_outside_zero_to_one_is_refused(scene, amount):
    with pytest.raises(ValueError, match=f"amount is {amount:g}, outside"):
        change_style(scene, 0.2, amount=amount)


def test_speech_of_a_waiting_block_may_still_change_when_it_is_replanned(scene, running):
    waiting = scene.with_block(replace(running, state=BlockState.LURKING))
    (request,) = change_style(waiting, 0.2, amount=0.5).replans
    assert not request.is_decided


def test_style_change_of_one_block_changes_its_behaviours_and_that_of_all_the_default(scene):
    after = change_style(scene, 0.2, style="calm", block="a")
    assert after.setup is scene.setup
    assert after.replans[0].block.behaviours[0].manner.style == "calm"
    whole = change_style(scene, 0.2, style="calm")
    assert whole.setup.style.name == "calm"
    assert whole.replans[0].block.behaviours[0].manner.style is None


def test_movement_amount_changed_after_the_style_keeps_the_style(scene):
    after = change_style(change_style(scene, 0.2, style="calm", block="a"), 0.2, amount=0.5)
    (behaviour,) = after.replans[0].block.behaviours
    assert (behaviour.action.amount, behaviour.manner.style) == (0.5, "calm")


@pytest.mark.parametrize(
    ("target", "replans", "spatial"), [("a", 1, 0.5), ("a:h", 1, 0.5), ("a:other", 1, None), ("b", 0, None)]
)
def test_parameter_change_applies_to_the_behaviours_that_its_target_names(scene, running, target, replans, spatial):
    after = change_parameter(scene, running, "p", ParameterChange(target, "spatial", "0.5"), 0.2)
    remaining, requests = take_replans(after)
    assert (remaining.replans, len(requests)) == ((), replans)
    assert [request.block.behaviours[0].manner.spatial for request in requests] == [spatial] * replans
    assert remaining.motion is scene.motion


def test_sender_of_an_invalid_parameter_change_is_warned(scene, running):
    after = change_parameter(scene, running, "p", ParameterChange("a", "volume", "0.5"), 0.2)
    assert after.replans == ()
    *earlier, warning = after.outgoing_feedback
    assert tuple(earlier) == scene.outgoing_feedback
    assert 'id="a:p" type="CUSTOM_BEHAVIOUR_NOT_SUPPORTED"' in warning.xml
    assert warning.time == 0.2


def test_movement_amount_change_of_a_block_that_cannot_be_scheduled_is_dropped_with_a_warning(scene, monkeypatch):
    def refuse(*_):
        raise module.BmlError("no time")

    monkeypatch.setattr(module, "retime_request", refuse)
    after = change_style(scene, 0.2, amount=0.5)
    assert after.replans == ()
    (warning,) = after.outgoing_feedback
    assert 'id="a"' in warning.xml
    assert "it is not changed: no time" in warning.xml
    assert warning.time == 0.2


BEHAVIOURS = {
    behaviour.id: behaviour
    for behaviour in parse(
        ROOT.format(
            "b",
            NOD
            + '<gesture id="g" lexeme="BEAT"/><torso id="t" lexeme="lean"/><faceLexeme id="f" lexeme="OPEN_MOUTH"/>',
        )
    ).behaviours
}


@pytest.mark.parametrize(
    ("id", "parameter", "value", "expected"),
    [
        ("h", "amount", "0.25", {"amount": 0.25}),
        ("t", "amount", "0", {"amount": 0.0}),
        ("f", "amount", "1", {"amount": 1.0}),
        ("g", "amount", "0.75", {"spatial": 0.5}),
        ("g", "amount", "0", {"spatial": -1.0}),
        ("h", "spatial", "-1", {"spatial": -1.0}),
        ("h", "power", "1", {"power": 1.0}),
        ("h", "style", "calm", {"style": "calm"}),
    ],
)
def test_parameter_changes_only_one_property_of_a_behaviour(id, parameter, value, expected):
    behaviour = BEHAVIOURS[id]
    changed = _parameter_change(parameter, value)(behaviour)
    name = next(iter(expected))
    is_action = name == "amount"
    part = changed.action if is_action else changed.manner
    assert part == replace(behaviour.action if is_action else behaviour.manner, **expected)
    assert replace(changed, action=behaviour.action, manner=behaviour.manner) == behaviour


@pytest.mark.parametrize(
    ("parameter", "value", "message"),
    [
        ("amount", "-0.1", r"amount is -0\.1, outside \[0, 1\]"),
        ("spatial", "1.1", r"spatial is 1\.1, outside \[-1, 1\]"),
        ("spatial", "-1.1", r"spatial is -1\.1, outside"),
        ("spatial", "wide", "spatial 'wide' is not a number; expected -1 to 1"),
        ("volume", "1", "parameter 'volume' cannot be changed; style, activation, amount, fluidity"),
    ],
)
def test_error_for_an_invalid_parameter_names_the_allowed_range_or_names(parameter, value, message):
    with pytest.raises(ValueError, match=message):
        _parameter_change(parameter, value)


OLD, NEW, PLACE = (Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "a:h", text) for text in ("old", "new", "place"))


@pytest.mark.parametrize(
    ("is_pending", "texts"),
    [
        pytest.param(True, ["new", "old"], id="provisional warnings were not sent yet"),
        pytest.param(False, ["new"], id="provisional warnings have been sent"),
    ],
)
def test_new_plan_reports_only_notices_that_were_not_sent_yet(scene, running, better, is_pending, texts):
    """Notices on body parts are sent at once, those on times later."""
    first = replace(better, keyframes=replace(better.keyframes, notices=(PLACE,)), notices=(PLACE, OLD))
    before = replace(running, prepared=replace(running.prepared, plan=first, is_provisional=True))
    later = replace(first, notices=(PLACE, NEW, OLD))
    new = replace(before, prepared=replace(before.prepared, plan=later, is_provisional=False))
    new = replace(new, predicted=(new.zero, new.times))
    pending = (ScheduledFeedback(0.9, "provisional", 0, unless_improved="a"),) if is_pending else ()
    other = (ScheduledFeedback(0.1, "other", 0, unless_improved="b"),)
    after = _announce(replace(scene, agenda=(*other, *pending)), before, new, 0.4)
    assert after.find("a") is new
    assert after.agenda[0] is other[0]
    assert [text for message in after.agenda for text in ("new", "old", "place") if f">{text}<" in message.xml] == texts
    assert {message.time for message in after.agenda[1:]} == {0.4}


@pytest.mark.parametrize(("shift", "is_predicted"), [(0.9 * SHIFT_TO_WARN, False), (1.1 * SHIFT_TO_WARN, True)])
def test_new_plan_is_predicted_only_if_its_times_change_by_more_than_a_threshold(
    scene, running, better, shift, is_predicted
):
    new = replace(running, predicted=(running.zero + shift, running.times))
    noticed = replace(better, notices=(NEW, OLD))
    new = replace(new, prepared=replace(new.prepared, plan=noticed))
    after = _announce(replace(scene, agenda=(ScheduledFeedback(0.4, "sent later", 0),)), running, new, 0.4)
    *messages, later = after.agenda
    assert ["<predictionFeedback" in message.xml for message in messages] == [True] * is_predicted + [False, False]
    assert later.content == "sent later"
    expected = (running.zero, running.times) if is_predicted else new.predicted
    assert after.find("a").predicted == expected
    assert times_by_behaviour(running.prepared.plan.syncs) == running.times

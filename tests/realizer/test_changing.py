"""Style changes and refined plans of running and waiting blocks."""

import numpy as np
import pytest

from kinesic.bml.block import Head
from kinesic.body.config import CONFIGS, ConfigError
from kinesic.expressivity.style.style import Style
from kinesic.motion.limit_check import check_limits
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import Scene, advance, begin, change_style, improve_block, prepare_block, take_replans
from kinesic.realizer.request import Message, TimedRequest, read_request

BML = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:bmla="http://www.asap-project.org/bmla" '
    'id="{}">{}</bml>'
)
NODS = '<head id="h" lexeme="NOD" repetition="6" amount="0.8"/>'
SPEECH = '<speech id="s"><text>One two three four five six seven</text></speech>'


def sent(scene: Scene, id: str, inside: str, now: float) -> Scene:
    coming = prepare_block(
        read_request(Message(BML.format(id, inside)), scene.setup, context=scene.context(now)), scene.setup
    )
    return begin(scene, coming, now)


def replanned(scene: Scene, now: float) -> tuple[Scene, tuple[TimedRequest, ...]]:
    """Return the scene with all possible replans applied."""
    scene, requests = take_replans(scene)
    for request in requests:
        scene = improve_block(scene, request.block.id, prepare_block(request, scene.setup).plan, now) or scene
    return scene, requests


def swing(scene: Scene, first: float, last: float) -> float:
    """Return the amplitude [rad] of the head's pitch."""
    times = np.arange(first, last, 0.01)
    neck = list(scene.setup.robot.joints("neck"))
    return float(np.ptp(scene.motion.sample(times)[0][:, neck], axis=0).max())


@pytest.fixture
def nodding(known: Setup) -> Scene:
    return sent(Scene.of(known), "a", NODS, 0.0)


def test_style_change_keeps_a_held_gaze_and_its_return_to_rest(known: Setup) -> None:
    look = '<gaze id="z" target="left" start="0" ready="1" relax="6" end="7"/><head id="h" lexeme="NOD" stroke="8"/>'
    scene = sent(Scene.of(known), "a", look, 0.0)
    held = scene.motion.at(5.0 - scene.motion.start).angles
    scene, requests = replanned(change_style(advance(scene, 4.0), 4.0, style="calm"), 4.1)
    assert requests
    assert scene.motion.start > 3.0, "the past in which the look began is forgotten"
    np.testing.assert_allclose(scene.motion.at(5.0).angles, held, atol=1e-6)
    np.testing.assert_allclose(scene.motion.controls[-1], known.robot.skeleton.rest, atol=1e-9)


def test_changed_movement_amount_applies_to_future_movements(nodding: Scene) -> None:
    before = swing(nodding, 1.8, 2.6)
    scene = change_style(advance(nodding, 1.0), 1.0, amount=0.3)
    assert scene.outgoing_feedback == ()
    scene, (request,) = replanned(scene, 1.0)
    action = request.block.behaviours[0].action
    assert isinstance(action, Head)
    assert action.amount == 0.3
    assert swing(scene, 1.8, 2.6) == pytest.approx(before * 0.3 / 0.8, rel=0.1)
    past = np.arange(0.0, 1.0, 0.01)
    np.testing.assert_allclose(scene.motion.sample(past)[0], nodding.motion.sample(past)[0], atol=1e-12)
    assert (
        max(peak.ratios.max() for peak in check_limits(scene.motion, scene.setup.limits).by_quantity.values()) <= 1.001
    )
    assert take_replans(scene)[1] == ()


def test_style_change_without_a_block_replans_running_blocks_and_sets_the_default_style(nodding: Scene) -> None:
    tense = Style.load("neutral").changed(["spatial=-0.8"])
    scene = change_style(nodding, 0.2, style=tense)
    assert scene.setup.style is tense
    assert [request.block.id for request in scene.replans] == ["a"]


def test_style_for_one_block_does_not_change_others(nodding: Scene) -> None:
    scene = sent(nodding, "b", '<gesture id="g" lexeme="BEAT"/>', 0.2)
    scene = change_style(scene, 0.3, style="neutral", block="b")
    (request,) = scene.replans
    assert (request.block.id, request.block.behaviours[0].manner.style) == ("b", "neutral")
    assert scene.setup.style is nodding.setup.style


def test_style_change_of_a_block_keeps_an_earlier_movement_amount(nodding: Scene) -> None:
    scene = change_style(nodding, 0.2, amount=0.4)
    scene = change_style(scene, 0.2, style="neutral", block="a")
    (request,) = scene.replans
    behaviour = request.block.behaviours[0]
    assert isinstance(behaviour.action, Head)
    assert (behaviour.action.amount, behaviour.manner.style) == (0.4, "neutral")


def test_style_change_does_not_change_a_started_speech(known: Setup) -> None:
    scene = sent(Scene.of(known), "a", SPEECH + NODS, 0.0)
    before = scene.speeches
    scene = change_style(scene, 0.5, style=Style.load("neutral").changed(["temporal=0.9"]))
    scene, (request,) = replanned(scene, 0.5)
    assert request.is_decided
    assert scene.speeches == before


def test_movement_amount_above_one_and_unknown_style_are_refused(nodding: Scene) -> None:
    with pytest.raises(ValueError, match=r"amount is 1\.5, outside \[0, 1\]"):
        change_style(nodding, 0.1, amount=1.5)
    with pytest.raises(ConfigError, match="nobody"):
        change_style(nodding, 0.1, style="nobody")


PARAMETER_CHANGE = (
    '<bmla:parameterValueChange id="p" target="{}" paramId="{}"><bmla:trajectory targetValue="{}"/>'
    "</bmla:parameterValueChange>"
)


@pytest.mark.parametrize(
    ("target", "parameter", "value"), [("a", "amount", 0.2), ("a:h", "spatial", -0.5), ("a", "style", "neutral")]
)
def test_block_changes_a_parameter_of_another_block(
    nodding: Scene, target: str, parameter: str, value: float | str
) -> None:
    scene = sent(nodding, "b", PARAMETER_CHANGE.format(target, parameter, value), 0.2)
    scene = advance(scene, 0.21)
    assert not [due for due in scene.outgoing_feedback if "<warning" in due.xml]
    (request,) = scene.replans
    changed = request.block.behaviours[0]
    assert getattr(changed.action if parameter == "amount" else changed.manner, parameter) == value
    assert improve_block(scene, "a", prepare_block(request, scene.setup).plan, 0.25) is not None


@pytest.mark.parametrize(
    ("parameter", "value", "said"),
    [
        ("volume", "100", "'volume' cannot be changed; style"),
        ("amount", "much", "'much' is not a number"),
        ("amount", "7", "outside [0, 1]"),
        ("style", "nobody", "nobody"),
        ("style", str(CONFIGS / "styles" / "calm.toml"), "no style "),
    ],
)
def test_invalid_parameter_change_causes_a_warning_and_no_replan(
    nodding: Scene, parameter: str, value: str, said: str
) -> None:
    scene = advance(sent(nodding, "b", PARAMETER_CHANGE.format("a", parameter, value), 0.2), 0.21)
    warnings = [due.xml for due in scene.outgoing_feedback if 'id="b:p"' in due.xml]
    assert len(warnings) == 1
    assert said in warnings[0]
    assert scene.replans == ()


HURRIED_BEATS = "".join(
    f'<gesture id="g{k}" lexeme="BEAT" mode="RIGHT_HAND" stroke="{1.2 + 0.5 * k}"/>' for k in range(5)
)


def test_quick_plan_of_a_running_block_is_replaced_once_by_its_refined_plan(play):
    play.send("a", HURRIED_BEATS)
    assert play.warnings() == []
    play.scene, (request,) = take_replans(play.scene)
    better = prepare_block(request, play.scene.setup).plan
    play.until(0.2)
    after = improve_block(play.scene, "a", better, play.now)
    assert after is not None
    assert take_replans(after)[1] == ()
    play.scene = after
    play.until(8.0)
    strokes = {sync.behaviour: sync.planned for sync in better.syncs if sync.sync == "stroke"}
    assert {id: play.at(f"a:{id}:stroke") for id in strokes} == pytest.approx(strokes, abs=0.011)
    assert len(play.predictions("a")) == 2
    assert len(play.warnings()) == len(better.notices)
    assert improve_block(play.scene, "a", better, play.now) is None


def test_prediction_feedback_of_a_new_plan_precedes_its_warnings(play):
    quick = play.ready("a", HURRIED_BEATS)
    better = prepare_block(quick.replan_request, play.scene.setup)
    play.take(begin(play.scene, better, play.now)).until(0.2)
    after = improve_block(play.scene, "a", quick.plan, play.now)
    assert after is not None
    messages = [due.xml for due in after.agenda if due.time == play.now]
    assert ["<predictionFeedback" in xml for xml in messages] == [True, *(False for _ in messages[1:])]
    assert len(messages) > len(quick.plan.notices) > 1


def test_refined_plan_of_a_block_uses_the_same_hands_as_its_quick_plan(play):
    play.send("a", '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND"/>').until(0.3)
    open_ = "".join(f'<gesture id="g{k}" lexeme="BEAT" stroke="{0.8 + 1.2 * k}"/>' for k in range(5))
    play.send("b", open_)
    play.scene, (request,) = take_replans(play.scene)
    better = prepare_block(request, play.scene.setup).plan
    before = play.scene.find("b").prepared.plan
    assert better.keyframes.uses == before.keyframes.uses
    assert before.keyframes.uses["g0"] == {"l_hand"}
    assert before.keyframes.uses["g4"] == {"r_hand"}
    assert improve_block(play.scene, "b", better, play.now) is not None


def test_provisional_warnings_are_sent_if_the_plan_is_not_refined(play):
    coming = play.ready("a", HURRIED_BEATS)
    play.take(begin(play.scene, coming, play.now)).until(8.0)
    assert len(play.warnings()) == len(coming.plan.notices) > 0


@pytest.mark.parametrize("delay", [0.2, 1.5])
def test_warnings_that_remain_after_a_refinement_are_sent_once(play, delay: float):
    """Provisional warnings are withdrawn in time, or have been sent already."""
    coming = play.ready("a", HURRIED_BEATS)
    play.take(begin(play.scene, coming, play.now)).until(delay)
    after = improve_block(play.scene, "a", coming.plan, play.now)
    assert after is not None
    play.take(after).until(8.0)
    assert len(play.warnings()) == len(coming.plan.notices) > 0


def test_waiting_block_takes_its_refined_plan(play):
    play.send("w", '<wait id="w" duration="1"/>').send("a", HURRIED_BEATS, 'composition="APPEND"')
    play.scene, (request,) = take_replans(play.scene)
    after = improve_block(play.scene, "a", prepare_block(request, play.scene.setup).plan, play.now)
    assert after is not None
    play.scene = after
    play.until(9.0)
    assert play.at("a:g4:stroke") == pytest.approx(1.0 + 1.2 + 0.5 * 4, abs=0.03)


def test_new_plan_with_another_gaze_shift_turns_the_trunk_after_the_motion_has_ended(play):
    wait, look = '<wait id="w" duration="6"/>', '<gazeShift id="l" target="{}"/>'
    play.send("a", wait + look.format("left")).until(3.0)
    assert play.scene.motion.end < play.now
    other = play.ready("a", wait + look.format("right")).plan
    improved = improve_block(play.scene, "a", other, play.now)
    assert improved is not None
    np.testing.assert_allclose(improved.motion.controls[-1], other.trajectory.controls[-1], atol=1e-6)

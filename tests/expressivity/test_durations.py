import numpy as np
import pytest

from kinesic.bml.block import (
    Behaviour,
    Block,
    Custom,
    Face,
    Gaze,
    Gesture,
    Head,
    Manner,
    Place,
    Pointing,
    Posture,
    Torso,
)
from kinesic.expressivity.durations import natural_durations
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.hands.strokes import least_stroke_times
from kinesic.expressivity.head import MAX_ADDED_STROKES
from kinesic.expressivity.style.effort import ACCENT_MARGIN
from kinesic.expressivity.style.pace import POWER_FACTOR
from kinesic.expressivity.style.style import Expressivity, Style

EXTENT_VALUES = np.linspace(-1.0, 1.0, 9)


@pytest.fixture
def natural(context):
    def of(action, manner=None, style=None):
        behaviour = Behaviour("b", "x", action, Place(1, 1), manner=manner or Manner())
        return natural_durations(context(Block("bml1", (behaviour,)), style)).get("b", {})

    return of


def test_gesture_has_durations_of_all_phases(natural):
    of = natural(Gesture("beat"))
    assert 0.3 < of["ready"] < of["end"]
    assert of["strokeStart"] == 0
    assert 0.0 < of["relax"] < of["stroke"] + of["strokeEnd"]


def test_gesture_durations_depend_on_tempo_and_category(natural, lexicon):
    assert lexicon.find("stop").form.tempo == "sudden"
    assert lexicon.find("calm_down").form.tempo == "sustained"
    sudden, neutral, sustained = (natural(Gesture(lexeme)) for lexeme in ("stop", "welcome", "calm_down"))
    assert sudden["ready"] < neutral["ready"] < sustained["ready"]
    assert natural(Pointing("left"))["relax"] > natural(Gesture("beat"))["relax"]


def test_rest_pose_gesture_has_no_hold_time(natural):
    assert natural(Gesture("arms_crossed"))["relax"] == 0


def test_temporal_extent_given_in_a_document_shortens_its_gesture(natural):
    usual, quick = natural(Gesture("large")), natural(Gesture("large"), manner=Manner(temporal=1.0))
    assert all(quick[sync] < usual[sync] for sync in ("ready", "stroke", "end"))


def test_repetition_parameter_adds_strokes_after_the_first_stroke(natural):
    once, thrice = natural(Gesture("beat")), natural(Gesture("beat"), style=Style.uniform(Expressivity(repetition=1.0)))
    assert thrice["stroke"] == pytest.approx(once["stroke"])
    assert thrice["stroke:2"] + thrice["stroke:3"] + thrice["strokeEnd"] > 2 * once["stroke"]


@pytest.mark.parametrize("sync", ["ready", "stroke", "relax", "end"])
def test_temporal_extent_shortens_every_gesture_phase(natural, sync):
    times = [natural(Gesture("beat"), manner=Manner(temporal=extent))[sync] for extent in EXTENT_VALUES]
    assert np.all(np.diff(times) < 0)
    assert times[0] > 1.4 * times[4]


@pytest.mark.parametrize("shift", [False, True])
def test_temporal_extent_shortens_facial_expression(natural, shift):
    durations = [natural(Face(("smile",), shift=shift), manner=Manner(temporal=extent)) for extent in (-1.0, 0.0, 1.0)]
    assert all(slow > usual > quick for slow, usual, quick in zip(*(of.values() for of in durations), strict=True))


@pytest.mark.parametrize("lexeme", ["beat", "stop", "large"])
def test_power_shortens_the_stroke_within_servo_limits_and_low_power_slows_all_movements(
    natural, pace, lexicon, lexeme
):
    durations = [natural(Gesture(lexeme), manner=Manner(power=power)) for power in EXTENT_VALUES]
    assert np.all(np.diff([of["stroke"] for of in durations]) < 0)
    for sync in ("ready", "end"):
        assert np.all(np.diff([of[sync] for of in durations[:5]]) < 0)
        assert len({of[sync] for of in durations[4:]}) == 1
    neutral = poses(lexicon.find(lexeme).form, pace.robot, Expressivity())
    least = sum(least_stroke_times(neutral, pace)[: neutral.stroke])
    assert durations[-1]["stroke"] == pytest.approx(max(durations[4]["stroke"] / POWER_FACTOR, ACCENT_MARGIN * least))
    assert [of["relax"] for of in durations] == pytest.approx([durations[0]["relax"]] * len(EXTENT_VALUES))


def test_natural_durations_depend_on_expressivity_of_the_moving_modality(natural):
    style = Style(head=Expressivity(temporal=-1.0), torso=Expressivity(power=1.0))
    assert natural(Head("NOD"), style=style)["stroke"] > 1.4 * natural(Head("NOD"))["stroke"]
    assert natural(Torso("BodyLean"), style=style)["ready"] < natural(Torso("BodyLean"))["ready"]
    assert natural(Gesture("beat"), style=style) == natural(Gesture("beat"))


def test_power_shortens_nod_and_repetition_adds_nods(natural):
    usual, sharp, more = (
        natural(Head("NOD", repetition=2), manner=manner)
        for manner in (Manner(), Manner(power=1.0), Manner(repetition=1.0))
    )
    assert sharp["stroke"] < usual["stroke"]
    assert sharp["stroke:2"] == pytest.approx(2 * sharp["stroke"])
    assert more["strokeEnd"] == pytest.approx(usual["strokeEnd"] + 2 * MAX_ADDED_STROKES * usual["stroke"])


def test_trunk_duration_of_a_posture_depends_on_torso_and_not_on_gesture_expressivity(natural):
    lean = Posture(poses=(("WHOLEBODY", "LEANING_FORWARD"),))
    slow = natural(lean, style=Style(torso=Expressivity(temporal=-1.0)))
    assert slow["ready"] > natural(lean)["ready"]
    assert natural(lean, style=Style(gesture=Expressivity(temporal=-1.0))) == natural(lean)


def test_repeated_nod_has_duration_for_each_stroke(natural):
    of = natural(Head("NOD", repetition=3))
    assert of["stroke:2"] == of["stroke:3"] == pytest.approx(2 * of["stroke"])
    assert 0.3 <= of["stroke"] + of["strokeEnd"] <= 0.5


@pytest.mark.parametrize(
    ("action", "syncs"),
    [
        (Gaze("left"), {"ready", "relax", "end"}),
        (Gaze("left", shift=True), {"end"}),
        (Posture("STANDING"), {"ready", "relax", "end"}),
        (Posture(poses=(("ARMS", "ARMS_CROSSED"),), shift=True), {"end"}),
        (Torso("BodyLean"), {"ready", "relax", "end"}),
    ],
)
def test_head_and_torso_behaviours_have_positive_durations(natural, action, syncs):
    of = natural(action)
    assert set(of) == syncs
    assert all(span > 0 for span in of.values())


def test_custom_and_unknown_behaviours_have_no_natural_durations(natural):
    assert natural(Custom("x:y")) == {}
    assert natural(Pointing("nowhere")) == {}
    assert natural(Gesture("xyzzy")) == {}

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
from kinesic.expressivity.durations import spans
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.hands.strokes import least_stroke_times
from kinesic.expressivity.head import MORE
from kinesic.expressivity.style.effort import ROOM_FOR_ACCENT
from kinesic.expressivity.style.pace import FORCE
from kinesic.expressivity.style.style import Expressivity, Style

EXTENTS = np.linspace(-1.0, 1.0, 9)


@pytest.fixture
def natural(context):
    def of(action, manner=None, style=None):
        behaviour = Behaviour("b", "x", action, Place(1, 1), manner=manner or Manner())
        return spans(context(Block("bml1", (behaviour,)), style)).get("b", {})

    return of


def test_a_gesture_has_all_phases(natural):
    of = natural(Gesture("beat"))
    assert 0.3 < of["ready"] < of["end"]
    assert of["strokeStart"] == 0
    assert 0.0 < of["relax"] < of["stroke"] + of["strokeEnd"]


def test_tempo_and_category_of_a_gesture_are_in_its_times(natural, lexicon):
    assert lexicon.find("stop").form.tempo == "sudden"
    assert lexicon.find("calm_down").form.tempo == "sustained"
    sudden, neutral, sustained = (natural(Gesture(lexeme)) for lexeme in ("stop", "offer", "calm_down"))
    assert sudden["ready"] < neutral["ready"] < sustained["ready"]
    assert natural(Pointing("left"))["relax"] > natural(Gesture("beat"))["relax"]


def test_a_rest_pose_is_not_held_before_it_is_left(natural):
    assert natural(Gesture("arms_crossed"))["relax"] == 0


def test_temporal_extent_of_the_document_makes_a_gesture_quicker(natural):
    usual, quick = natural(Gesture("large")), natural(Gesture("large"), manner=Manner(temporal=1.0))
    assert all(quick[sync] < usual[sync] for sync in ("ready", "stroke", "end"))


def test_repetition_adds_strokes_after_the_first(natural):
    once, thrice = natural(Gesture("beat")), natural(Gesture("beat"), style=Style.uniform(Expressivity(repetition=1.0)))
    assert thrice["stroke"] == pytest.approx(once["stroke"])
    assert thrice["stroke:2"] + thrice["stroke:3"] + thrice["strokeEnd"] > 2 * once["stroke"]


@pytest.mark.parametrize("sync", ["ready", "stroke", "relax", "end"])
def test_temporal_extent_shortens_every_phase_of_a_gesture(natural, sync):
    times = [natural(Gesture("beat"), manner=Manner(temporal=extent))[sync] for extent in EXTENTS]
    assert np.all(np.diff(times) < 0)
    assert times[0] > 1.4 * times[4]


@pytest.mark.parametrize("shift", [False, True])
def test_temporal_extent_hurries_a_face(natural, shift):
    found = [natural(Face(("smile",), shift=shift), manner=Manner(temporal=extent)) for extent in (-1.0, 0.0, 1.0)]
    assert all(slow > usual > quick for slow, usual, quick in zip(*(of.values() for of in found), strict=True))


@pytest.mark.parametrize("lexeme", ["beat", "stop", "large"])
def test_power_hurries_the_stroke_as_far_as_the_servos_allow_and_weakness_slows_all(natural, pace, lexicon, lexeme):
    found = [natural(Gesture(lexeme), manner=Manner(power=power)) for power in EXTENTS]
    assert np.all(np.diff([of["stroke"] for of in found]) < 0)
    for sync in ("ready", "end"):
        assert np.all(np.diff([of[sync] for of in found[:5]]) < 0)
        assert len({of[sync] for of in found[4:]}) == 1
    neutral = poses(lexicon.find(lexeme).form, pace.robot, Expressivity())
    least = sum(least_stroke_times(neutral, pace)[: neutral.stroke])
    assert found[-1]["stroke"] == pytest.approx(max(found[4]["stroke"] / FORCE, ROOM_FOR_ACCENT * least))
    assert [of["relax"] for of in found] == pytest.approx([found[0]["relax"]] * len(EXTENTS))


def test_temporal_extent_and_power_are_those_of_the_modality(natural):
    style = Style(head=Expressivity(temporal=-1.0), torso=Expressivity(power=1.0))
    assert natural(Head("NOD"), style=style)["stroke"] > 1.4 * natural(Head("NOD"))["stroke"]
    assert natural(Torso("BodyLean"), style=style)["ready"] < natural(Torso("BodyLean"))["ready"]
    assert natural(Gesture("beat"), style=style) == natural(Gesture("beat"))


def test_power_sharpens_a_nod_and_repetition_adds_some(natural):
    usual, sharp, more = (
        natural(Head("NOD", repetition=2), manner=manner)
        for manner in (Manner(), Manner(power=1.0), Manner(repetition=1.0))
    )
    assert sharp["stroke"] < usual["stroke"]
    assert sharp["stroke:2"] == pytest.approx(2 * sharp["stroke"])
    assert more["strokeEnd"] == pytest.approx(usual["strokeEnd"] + 2 * MORE * usual["stroke"])


def test_the_trunk_of_a_posture_is_moved_in_its_own_manner(natural):
    lean = Posture(poses=(("WHOLEBODY", "LEANING_FORWARD"),))
    slow = natural(lean, style=Style(torso=Expressivity(temporal=-1.0)))
    assert slow["ready"] > natural(lean)["ready"]
    assert natural(lean, style=Style(gesture=Expressivity(temporal=-1.0))) == natural(lean)


def test_a_nod_takes_a_span_for_each_stroke(natural):
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
def test_what_moves_head_or_torso_has_spans(natural, action, syncs):
    of = natural(action)
    assert set(of) == syncs
    assert all(span > 0 for span in of.values())


def test_what_moves_nothing_has_no_spans(natural):
    assert natural(Custom("x:y")) == {}
    assert natural(Pointing("nowhere")) == {}
    assert natural(Gesture("xyzzy")) == {}

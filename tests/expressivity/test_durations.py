from dataclasses import replace

import pytest

from kinesic.bml.block import Behaviour, Block, Custom, Gaze, Gesture, Head, Manner, Place, Pointing, Posture, Torso
from kinesic.expressivity.durations import spans
from kinesic.expressivity.pace import FLOOR
from kinesic.expressivity.style import Style


@pytest.fixture
def natural(pace, lexicon):
    def of(action, manner=None, style=None):
        behaviour = Behaviour("b", "x", action, Place(1, 1), manner=manner or Manner())
        return spans(Block("bml1", (behaviour,)), style=style or Style(), lexicon=lexicon, pace=pace).get("b", {})

    return of


def test_a_gesture_has_all_phases(natural):
    of = natural(Gesture("beat"))
    assert of["ready"] >= FLOOR
    assert of["end"] >= FLOOR
    assert of["strokeStart"] == 0
    assert of["relax"] == pytest.approx(0.5 * (of["stroke"] + of["strokeEnd"]))


def test_a_rest_pose_is_not_held_before_it_is_left(natural):
    assert natural(Gesture("arms_crossed"))["relax"] == 0


def test_temporal_extent_of_the_document_makes_a_gesture_quicker(natural):
    usual, quick = natural(Gesture("large")), natural(Gesture("large"), manner=Manner(temporal=1.0))
    assert all(quick[sync] < usual[sync] for sync in ("ready", "stroke", "end"))


def test_repetition_lengthens_the_stroke(natural):
    once, thrice = natural(Gesture("beat")), natural(Gesture("beat"), style=replace(Style(), repetition=1.0))
    assert thrice["stroke"] == pytest.approx(once["stroke"])
    assert thrice["strokeEnd"] > 3 * once["stroke"]


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

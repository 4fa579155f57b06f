"""Standing postures from tables of style files, and the choice of rest gestures."""

from collections import Counter
from math import radians

import numpy as np
import pytest

from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.standing import (
    FRONTAL_GAZE,
    NEUTRAL_STANDING,
    UNPOSED_STANDING,
    USUAL_PAUSES,
    GazeHabit,
    Standing,
    StandingTable,
    StandingTurnTable,
    choose_rest,
)


def test_standing_posture_has_the_values_of_its_toml_table_in_radians():
    table = StandingTable(
        head=StandingTurnTable(10.0, 20.0, 30.0),
        trunk=StandingTurnTable(tilt=5.0),
        arms={"flexion": 15.0},
        fist=0.3,
        rest="hand_on_hip",
        mirrored=True,
        pauses={"arms_crossed": 2.0},
        face={"HAPPY": 0.5},
        gaze_down=30.0,
        gaze_aside=40.0,
        averted=0.6,
    )
    standing = Standing.of(table)
    assert standing.head == Turn(radians(10.0), radians(20.0), radians(30.0))
    assert standing.trunk == Turn(0.0, radians(5.0), 0.0)
    assert standing.arms == (("flexion", radians(15.0)),)
    assert (standing.fist, standing.rest, standing.mirrored) == (0.3, "hand_on_hip", True)
    assert (standing.pauses, standing.face) == ((("arms_crossed", 2.0),), (("HAPPY", 0.5),))
    assert standing.gaze == GazeHabit(radians(30.0), radians(40.0), 0.6)


def test_only_a_standing_posture_with_hanging_arms_has_the_usual_pause_gestures():
    assert NEUTRAL_STANDING.pauses == USUAL_PAUSES
    assert NEUTRAL_STANDING.gaze == FRONTAL_GAZE
    assert Standing.of(StandingTable(rest="hand_on_hip")).pauses == ()
    assert Standing.of(StandingTable(arms={"flexion": 1.0})).pauses == ()
    assert Standing.of(StandingTable(rest="x", pauses={"y": 1.0})).pauses == (("y", 1.0),)


@pytest.mark.parametrize(
    "standing",
    [
        Standing(head=Turn(0.1)),
        Standing(trunk=Turn(0.1)),
        Standing(arms=(("flexion", 0.1),)),
        Standing(fist=0.1),
        Standing(rest="hand_on_hip"),
    ],
)
def test_standing_posture_with_a_rotation_fist_or_rest_gesture_requests_body_motion(standing: Standing):
    assert standing.moves_body


@pytest.mark.parametrize("standing", [NEUTRAL_STANDING, UNPOSED_STANDING, Standing(face=(("HAPPY", 1.0),))])
def test_upright_standing_posture_requests_no_body_motion(standing: Standing):
    assert not standing.moves_body


def test_facial_affect_of_a_style_is_scaled_by_its_weight_up_to_one():
    standing = Standing(face=(("HAPPY", 0.5), ("FEAR", 0.8)))
    assert standing.affect(0.5) == {"HAPPY": 0.25, "FEAR": 0.4}
    assert standing.affect(2.0) == {"HAPPY": 1.0, "FEAR": 1.0}
    assert standing.affect(0.0) == {}


def test_rest_gestures_are_chosen_by_their_weights():
    chance = np.random.default_rng(0)
    counts = Counter(choose_rest((("hanging", 3.0), ("arms_crossed", 1.0)), chance) for _ in range(400))
    assert set(counts) == {"", "arms_crossed"}
    assert 260 < counts[""] < 340
    assert choose_rest((), chance) is None

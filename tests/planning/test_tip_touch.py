"""Touches by the tip that is meant: it hovers, and nothing of the hand is nearer."""

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.controller.perform import set_up
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.planning.collision import EXACT, HOVER, SLACK, TipTouch
from kinesic.studies.gestures.isolated import plan_gesture


@pytest.fixture(scope="module")
def known():
    return set_up("upper36")


@pytest.mark.parametrize("name", ["hush", "own_mouth", "think", "phone_call", "steeple", "watch_time"])
def test_the_tip_that_is_meant_hovers_and_the_rest_stays_away(known, name):
    form, robot = known.lexicon.forms_by_id[name], known.robot
    planned = plan_gesture(form, known)
    keyed = np.array([posture.angles for posture in planned.postures.postures])
    for key in form.keys:
        for side, pose in key.hands.items():
            if pose.tip is not None:
                touch = TipTouch.of(side, Hand(touch=pose.touch, tip=pose.tip), robot)
                assert touch is not None
                gaps = touch.gaps(keyed)
                assert HOVER - EXACT <= gaps.min() <= HOVER + SLACK + EXACT
                assert known.distances.gaps(keyed[gaps.argmin()][None]).min() >= HOVER - EXACT


def test_a_hand_without_that_finger_or_without_a_touch_has_no_tip(known):
    plain = set_up("upper22").robot
    assert TipTouch.of("r", Hand(touch="head", tip="index"), plain) is None
    assert TipTouch.of("r", Hand(tip="index"), known.robot) is None
    assert TipTouch.of("r", Hand(touch="head"), known.robot) is None


def test_a_tip_needs_something_to_touch(tmp_path):
    file = tmp_path / "mine.toml"
    hand = '{ right = { at = [0.3, 0.2, 0.5], tip = "index" } }'
    file.write_text(f'category = "emblem"\n[[gesture]]\nid = "poke"\nkeys = [{hand}]\n', encoding="utf-8")
    with pytest.raises(ConfigError, match="gesture poke: tip is 'index' and touch is missing"):
        Lexicon.load(file)

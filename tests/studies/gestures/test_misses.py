"""Hands reach their targets in every style."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.config import names_of
from kinesic.expressivity.style.style import Style
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import plan_gesture

MAX_WRIST_MISS = 0.03  # [m] largest distance of a wrist to its target
MAX_CLAP_GAP = 0.04  # [m] largest distance of clapping hands

CHECKED_GESTURES = ("throw_ball", "fly_bird", "love", "greet_bow_hand", "watch_time")
STYLES = names_of("style")


@pytest.fixture(scope="module")
def known():
    return set_up()


@pytest.mark.parametrize("gesture", CHECKED_GESTURES)
def test_gesture_hands_reach_their_targets_in_every_style(known, gesture):
    form = known.lexicon.forms_by_id[gesture]
    for style in (Style.load(name) for name in STYLES):
        misses = plan_gesture(form, replace(known, style=style)).postures.misses
        assert max(misses.values()) < MAX_WRIST_MISS, style.name


@pytest.mark.parametrize("robot", ["upper22", "upper36"])
@pytest.mark.parametrize("style", ["joyful", "shy"])
def test_clapping_hands_come_within_4_cm_at_every_clap(robot, style):
    setup = set_up(robot, style=style)
    planned = plan_gesture(setup.lexicon.forms_by_id["applause"], setup)
    claps = [sync.planned for sync in planned.syncs if sync.is_stroke]
    assert len(claps) >= 2
    angles = planned.trajectory.sample(planned.trajectory.zero + np.array(claps))[0]
    hands = [setup.robot.arm(side).bodies for side in ("l", "r")]
    pairs = [k for k, pair in enumerate(setup.robot.counted_pairs) if all(set(pair) & body for body in hands)]
    assert setup.distances.gaps(angles)[:, pairs].min(axis=1).max() < MAX_CLAP_GAP

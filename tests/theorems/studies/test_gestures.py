"""What holds for every gesture of the lexicon when it is played."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.controller.perform import set_up
from kinesic.expressivity.lexicon.lexicon import mirror_form
from kinesic.studies.gestures.isolated import plan_gesture

KNOWN = set_up()
MIRRORED = replace(KNOWN, lexicon=KNOWN.lexicon.changed(mirror_form))
NAMES = list(KNOWN.robot.skeleton.names)
ONE_HANDED = [form for form in KNOWN.lexicon.forms if len(form.sides) == 1]
ALIKE = [
    form
    for form in KNOWN.lexicon.forms
    if len(form.sides) == 2 and all(key.hands.get("l") is key.hands.get("r") for key in form.keys)
]
SWAPPED = [NAMES.index({"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]) for name in NAMES]
SIGNS = np.array([-1.0 if name[:2] not in ("l_", "r_") and not name.endswith("tilt") else 1.0 for name in NAMES])


def mirrored(angles):
    """Postures (m, n) as a mirror shows them."""
    return SIGNS * angles[:, SWAPPED]


def motion(planned):
    """(m, n) [rad] every 10 ms."""
    return planned.trajectory.sample(np.arange(0.0, planned.trajectory.duration, 0.01))[0]


@settings(max_examples=15, deadline=None)
@given(st.sampled_from(ONE_HANDED))
def test_a_gesture_of_the_left_hand_mirrors_that_of_the_right(form):
    left, right = motion(plan_gesture(form, KNOWN, "left")), motion(plan_gesture(form, KNOWN, "right"))
    assert left == pytest.approx(mirrored(right), abs=1e-9)


@settings(max_examples=8, deadline=None)
@given(st.sampled_from(ALIKE))
def test_hands_alike_are_their_own_mirror_image_where_they_move_alone(form):
    both = motion(plan_gesture(form, replace(KNOWN, style=KNOWN.style.changed(["whole_body=0"]))))
    assert both == pytest.approx(mirrored(both), abs=1e-9)


@settings(max_examples=8, deadline=None)
@given(st.sampled_from(KNOWN.lexicon.forms))
def test_a_mirrored_gesture_moves_the_whole_body_as_a_mirror_shows_it(form):
    assert motion(plan_gesture(form, MIRRORED)) == pytest.approx(mirrored(motion(plan_gesture(form, KNOWN))), abs=1e-9)

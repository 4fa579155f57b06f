"""Properties of every gesture of the lexicon in motion."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.expressivity.lexicon.lexicon import mirror_form
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import plan_gesture

from ...examples import examples

PLAN_SETUP = set_up()
# setup whose gestures are mirror images
MIRRORED_SETUP = replace(PLAN_SETUP, lexicon=PLAN_SETUP.lexicon.changed(mirror_form))
HINGE_NAMES = list(PLAN_SETUP.robot.skeleton.names)
ONE_HANDED_FORMS = [form for form in PLAN_SETUP.lexicon.forms if len(form.sides) == 1]  # gestures of one hand
SYMMETRIC_FORMS = [
    form
    for form in PLAN_SETUP.lexicon.forms
    if len(form.sides) == 2 and all(key.hands.get("l") is key.hands.get("r") for key in form.keys)
]
# index of each hinge's mirror image
MIRROR_HINGES = [HINGE_NAMES.index({"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]) for name in HINGE_NAMES]
MIRROR_TOLERANCE = 5e-4  # [rad] rounding errors reach 1e-4, as the contact of a hand is searched iteratively
MIRROR_SIGNS = np.array(
    [-1.0 if name[:2] not in ("l_", "r_") and not name.endswith("tilt") else 1.0 for name in HINGE_NAMES]
)


def mirrored(angles):
    """Return the mirror images of postures (m, n)."""
    return MIRROR_SIGNS * angles[:, MIRROR_HINGES]


def motion(planned):
    """Return the postures (m, n) [rad] every 10 ms."""
    return planned.trajectory.sample(np.arange(0.0, planned.trajectory.duration, 0.01))[0]


@examples(50)
@given(st.sampled_from(ONE_HANDED_FORMS))
def test_left_handed_gesture_mirrors_the_right_handed_gesture(form):
    left, right = motion(plan_gesture(form, PLAN_SETUP, "left")), motion(plan_gesture(form, PLAN_SETUP, "right"))
    assert left == pytest.approx(mirrored(right), abs=MIRROR_TOLERANCE)


@examples(27)
@given(st.sampled_from(SYMMETRIC_FORMS))
def test_symmetric_gestures_are_their_own_mirror_image(form):
    both = motion(plan_gesture(form, replace(PLAN_SETUP, style=PLAN_SETUP.style.changed(["whole_body=0"]))))
    assert both == pytest.approx(mirrored(both), abs=MIRROR_TOLERANCE)


@pytest.mark.soak
@settings(max_examples=8, deadline=None)
@given(st.sampled_from(PLAN_SETUP.lexicon.forms))
def test_mirrored_gesture_mirrors_the_whole_body(form):
    assert motion(plan_gesture(form, MIRRORED_SETUP)) == pytest.approx(
        mirrored(motion(plan_gesture(form, PLAN_SETUP))), abs=MIRROR_TOLERANCE
    )

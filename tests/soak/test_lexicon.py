"""Gestures of the lexicon in every style and with their mirror images."""

import numpy as np
import pytest

from kinesic.bench.expressivity.lexicon import list_tasks, play_gestures
from kinesic.body.config import names_of
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import plan_gesture

pytestmark = pytest.mark.soak


def test_all_gestures_in_all_styles_keep_limits_and_clearance_and_report_moved_times():
    results = list(play_gestures(list_tasks(names_of("style"))))
    assert [result for result in results if result.penetrations or result.violations] == []
    assert [result for result in results if result.dropped or not result.reported] == []
    assert [result for result in results if result.style == "neutral" and not result.on_time] == []


def test_left_and_right_variants_of_every_one_handed_gesture_are_mirrored():
    known = set_up()
    names = list(known.robot.skeleton.names)
    swapped = [names.index({"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]) for name in names]
    signs = np.array([-1.0 if name[:2] not in ("l_", "r_") and not name.endswith("tilt") else 1.0 for name in names])
    for form in known.lexicon.forms:
        if len(form.sides) == 1:
            left, right = (plan_gesture(form, known, mode).trajectory for mode in ("left", "right"))
            times = np.arange(0.0, left.duration, 0.01)
            mirror = signs * right.sample(times)[0][:, swapped]
            assert left.sample(times)[0] == pytest.approx(mirror, abs=1e-9), form.id

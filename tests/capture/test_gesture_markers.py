"""Gesture markers from the velocity of the wrists."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.bench.blocks import find_corpus
from kinesic.body.arrays import sealed
from kinesic.capture.clip import ArmPath, BodyClip
from kinesic.capture.gesture_markers import find_markers, gesture_markers
from kinesic.capture.read import read_clip
from kinesic.expressivity.lexicon.captured_form import MARKER_NAMES
from kinesic.motion.easing import minimum_jerk

CORPUS = find_corpus()
CLIPS = sorted((CORPUS / "capture").rglob("*.skm")) if CORPUS else []
TIMES = np.arange(0.0, 4.0, 1 / 60)  # [s] frame times of a synthetic clip


def clip(*moves: tuple[float, float, float]) -> BodyClip:
    """Return a clip whose right wrist makes moves (start [s], end [s], height)."""
    height = sum(rise * minimum_jerk(np.clip((TIMES - start) / (end - start), 0.0, 1.0)) for start, end, rise in moves)
    still = np.tile([0.1, 0.0, -0.9], (len(TIMES), 1))
    moving = still + np.outer(height, [0.3, 0.0, 1.0])
    arms = {"l": ArmPath(sealed(still / 2), sealed(still)), "r": ArmPath(sealed(moving / 2), sealed(moving))}
    return BodyClip(sealed(TIMES), arms, sealed(np.zeros((len(TIMES), 3))))


def test_stroke_marker_is_at_the_stop_after_the_first_wrist_movement():
    markers = find_markers(clip((0.5, 1.2, 0.6), (2.2, 3.0, -0.6)))
    assert abs(markers["stroke"] - 1.2) < 0.55  # anywhere in the hold would do; the hold begins at 1.2 s
    assert 0.5 <= markers["strokeStart"] < 1.2
    assert abs(markers["start"] - 0.5) < 0.15
    assert abs(markers["relax"] - 2.2) < 0.2


def test_stroke_marker_is_within_30_ms_of_a_reversal_of_the_wrist():
    assert abs(find_markers(clip((0.5, 1.2, 0.6), (1.2, 1.9, -0.6)))["stroke"] - 1.2) < 0.03


def test_gesture_markers_of_a_motionless_clip_are_in_order():
    markers = find_markers(clip((0.5, 1.2, 0.0)))
    assert markers["start"] == 0.0
    assert 0.0 < markers["stroke"] < markers["end"]


def test_gesture_markers_in_the_file_replace_detected_ones_and_are_put_in_order():
    moving = clip((0.5, 1.2, 0.6), (2.2, 3.0, -0.6))
    given = {"ready": 0.9, "strokeStart": 0.8, "stroke": 1.5, "strokeEnd": 9.0, "relax": 2.0}
    markers, is_found = gesture_markers(replace(moving, syncs=given))
    assert not is_found
    assert markers["stroke"] == 1.5
    assert markers["strokeStart"] == markers["ready"] == 0.8
    assert markers["strokeEnd"] == pytest.approx(TIMES[-1])
    assert gesture_markers(moving)[1]


@pytest.mark.skipif(not CLIPS, reason="no captured clips (KINESIC_CORPUS)")
def test_gesture_markers_of_all_corpus_clips_are_in_order():
    paths = CLIPS[::20]
    for path in paths:
        read = read_clip(path)
        for markers in (find_markers(read), gesture_markers(read)[0]):
            times = [markers[name] for name in MARKER_NAMES]
            assert all(a <= b for a, b in pairwise(times)), path
            assert times[0] >= 0.0
            assert times[-1] <= read.times[-1] + 0.05

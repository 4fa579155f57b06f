"""Frechet distance between sets of clips."""

import numpy as np
import pytest

from kinesic.bench.capture.path_distribution import frechet_distance, sample_features
from kinesic.capture.clip import ArmPath

RNG = np.random.default_rng(0)


def test_frechet_distance_of_clip_sets_measures_shift_and_spread_in_standard_deviations():
    clips = list(RNG.normal(0.0, 3.0, (4, 500, 6)))
    assert frechet_distance(clips, clips) == pytest.approx(0.0, abs=1e-6)
    scale = np.concatenate(clips).std(axis=0)
    assert frechet_distance(clips, [clip + 0.5 * scale for clip in clips]) == pytest.approx(0.5 * np.sqrt(6))
    middle = np.concatenate(clips).mean(axis=0)
    wide = [middle + 2.0 * (clip - middle) for clip in clips]
    assert frechet_distance(clips, wide) == pytest.approx(np.sqrt(6), rel=1e-3)


def test_clip_features_are_elbows_wrists_and_velocities_of_both_arms():
    times = np.arange(50)[:, None] / 100.0
    left = ArmPath(times * [1.0, 0.0, 0.0], times * [0.0, 2.0, 0.0])
    right = ArmPath(times * [0.0, 0.0, 3.0], np.zeros((50, 3)))
    features = sample_features({"r": right, "l": left})
    assert features.shape == (10, 24)
    assert features[2, [0, 4, 8]] == pytest.approx([0.1, 0.2, 0.3])
    assert features[2, [12, 16, 20]] == pytest.approx([0.1, 0.2, 0.3])  # velocities of 1, 2 and 3 times 0.1 s
    assert np.abs(features[2]).sum() == pytest.approx(1.2)

"""Tests of unlimited motions of all hinges against those of single hinges."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import pieces
from kinesic.motion.spline_program import KEPT_RATIO, find_free_motion
from kinesic.motion.trajectory import KNOT_INTERVAL

from ..reference.motion import spline_programs as reference

# limits of three hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 3) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def keys(seed: int) -> Keys:
    """Return random keys of three hinges with movements, holds and paths."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.choice([0.07, 0.31, 0.6, 1.3, 3.2], 12)) + rng.uniform(0.0, 0.01, 12)
    times[-1] = times[-2] + 0.008
    angles = np.cumsum(rng.normal(0.0, 0.2, (12, 3)) * (rng.random((12, 3)) < 0.5), axis=0).clip(-1.5, 1.5)
    angles[-1] = angles[-2]
    postures = tuple(
        KeyPosture(
            float(time),
            sealed(row),
            (True, True, True) if k in (0, 11) else tuple(map(bool, rng.random(3) < 0.7)),
            is_exact=k in (0, 11) or bool(rng.random() < 0.8),
        )
        for k, (time, row) in enumerate(zip(times, angles, strict=True))
    )
    return Keys.of(postures, JOINT_LIMITS)


def wish(asked: Keys) -> Floats:
    knots = np.arange(pieces(asked.requested_times, KNOT_INTERVAL) + 1) * KNOT_INTERVAL + asked.requested_times[0]
    return np.stack([np.interp(knots, asked.requested_times, column) for column in asked.angles.T], axis=1)


@pytest.mark.parametrize("seed", range(12))
def test_motion_without_limits_equals_the_reference_computed_hinge_by_hinge(seed: int):
    asked = keys(seed)
    ours, beyond = find_free_motion(asked.requested_times, asked, JOINT_LIMITS, wish(asked))
    theirs, expected = reference.find_free_motion(asked.requested_times, asked, JOINT_LIMITS, wish(asked))
    np.testing.assert_allclose(ours, theirs, atol=1e-9)
    shares, segments = zip(*beyond, strict=True)
    others, wanted = zip(*expected, strict=True)
    np.testing.assert_allclose(shares, others, rtol=1e-6)
    for result, other in zip(segments, wanted, strict=True):
        for name in ("hinge", "first", "grid", "marks", "start", "end", "has_path"):
            assert getattr(result, name) == getattr(other, name), name
        np.testing.assert_array_equal(result.places, other.places)


def test_motion_without_limits_through_slow_keys_has_no_segments_beyond_limits():
    asked = keys(3)
    slow = replace(asked, requested_times=asked.requested_times * 50.0)
    free, beyond = find_free_motion(slow.requested_times, slow, JOINT_LIMITS, wish(slow))
    assert not beyond
    assert np.abs(np.diff(free, axis=0)).max() / KNOT_INTERVAL <= KEPT_RATIO * 4.0

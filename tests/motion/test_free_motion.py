"""The kernel cuts all hinges and finds their free motions as Python does, hinge by hinge."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion import spline_program
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import pieces
from kinesic.motion.spline_program import WITHIN, _find_in_python, find_free_motion
from kinesic.motion.trajectory import STEP

LIMITS = Limits(*(sealed([value] * 3) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))

pytestmark = pytest.mark.skipif(spline_program.KERNEL == "numpy", reason="no compiled kernel")


def keys(seed: int) -> Keys:
    """Moves, short and long holds, and paths; the last key of a hinge may come within a step of its rest."""
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
            firm=k in (0, 11) or bool(rng.random() < 0.8),
        )
        for k, (time, row) in enumerate(zip(times, angles, strict=True))
    )
    return Keys.of(postures, LIMITS)


def wish(asked: Keys) -> Floats:
    knots = np.arange(pieces(asked.asked, STEP) + 1) * STEP + asked.asked[0]
    return np.stack([np.interp(knots, asked.asked, column) for column in asked.angles.T], axis=1)


@pytest.mark.parametrize("seed", range(12))
def test_all_hinges_at_once_are_as_one_by_one(seed: int):
    asked = keys(seed)
    ours, beyond = find_free_motion(asked.asked, asked, LIMITS, wish(asked))
    theirs, expected = _find_in_python(asked.asked, asked, LIMITS, wish(asked))
    np.testing.assert_allclose(ours, theirs, atol=1e-9)
    shares, segments = zip(*beyond, strict=True)
    others, wanted = zip(*expected, strict=True)
    np.testing.assert_allclose(shares, others, rtol=1e-6)
    for found, other in zip(segments, wanted, strict=True):
        for name in ("hinge", "first", "grid", "marks", "start", "end", "led"):
            assert getattr(found, name) == getattr(other, name), name
        np.testing.assert_array_equal(found.places, other.places)


def test_what_keeps_the_limits_is_no_segment_of_its_own():
    asked = keys(3)
    slow = replace(asked, asked=asked.asked * 50.0)
    free, beyond = find_free_motion(slow.asked, slow, LIMITS, wish(slow))
    assert not beyond
    assert np.abs(np.diff(free, axis=0)).max() / STEP <= WITHIN * 4.0

"""Every sampled state of a conditioned motion obeys every limit, whatever is asked."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.controller.condition import condition
from kinesic.controller.postures import Posture
from kinesic.controller.trajectory import Manner

LIMITS = Limits(sealed([-1.5] * 3), sealed([1.5] * 3), sealed([1.0, 4.0, 6.0]), sealed([10.0, 59.0, 350.0]))

gaps = st.floats(0.021, 1.5)
rows = st.lists(st.tuples(gaps, st.tuples(*[st.floats(-1.5, 1.5)] * 3), st.integers(0, 7)), min_size=2, max_size=9)
manners = st.builds(Manner, st.floats(-1, 1), st.floats(-1, 0), st.floats(-1, 1))


@settings(max_examples=150, deadline=None)
@given(rows, manners)
def test_limits_hold(rows, manner):
    times = np.cumsum([gap for gap, _, _ in rows])
    last = len(rows) - 1
    keys = tuple(
        Posture(
            float(time),
            sealed(angles),
            tuple(k in (0, last) or bool(mask >> hinge & 1) for hinge in range(3)),
            (("b", "stroke" if k % 2 else "relax"),),
        )
        for k, (time, (_, angles, mask)) in enumerate(zip(times, rows, strict=True))
    )
    motion = condition(keys, LIMITS, manner)
    at = np.arange(0.0, motion.trajectory.duration, 1e-3)
    angles, speeds, accelerations = motion.trajectory.sample(at)
    assert np.all(np.abs(speeds) <= 1.001 * LIMITS.speed)
    assert np.all(np.abs(accelerations) <= 1.001 * LIMITS.acceleration)
    assert np.all(np.abs(angles) <= 1.5 + 1e-6)
    for hinge in range(angles.shape[1]):
        own = [k for k, key in enumerate(keys) if key.keyed[hinge]]
        assert np.all(np.diff(motion.planned[own]) > 0)

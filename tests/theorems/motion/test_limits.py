"""Every sample of a conditioned motion is within every limit."""

from typing import get_args

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.condition import condition
from kinesic.motion.easing import Easing
from kinesic.motion.keys import KeyPassage, KeyPosture
from kinesic.motion.limit_check import check_limits

from ...examples import examples

# angle, velocity, acceleration and jerk limits of three hinges
BOX_LIMITS = ([-1.5] * 3, [1.5] * 3, [1.0, 4.0, 6.0], [10.0, 59.0, 350.0], [250.0, 1500.0, 8750.0])
# duty per acceleration, duty per velocity and duty limit of three hinges
DUTY_LIMITS = ([0.05, 0.01, 0.002], [0.8, 0.18, 0.134], [0.58, 0.65, 0.79])
JOINT_LIMITS = Limits(*(sealed(values) for values in (*BOX_LIMITS, *DUTY_LIMITS)))

gaps = st.floats(0.021, 1.5)
passages = st.builds(
    KeyPassage, st.floats(-1, 1), st.floats(-1, 0), st.floats(-1, 1), st.sampled_from(get_args(Easing)), st.floats(1, 8)
)

angles = st.tuples(*[st.floats(-1.5, 1.5)] * 3)
rows = st.lists(st.tuples(gaps, angles, st.integers(0, 7), st.tuples(*[passages] * 3)), min_size=2, max_size=9)


@examples(40)
@given(rows)
def test_conditioned_motion_keeps_limits_and_passes_its_keys(rows):
    times = np.cumsum([gap for gap, *_ in rows])
    last = len(rows) - 1
    keys = tuple(
        KeyPosture(
            float(time),
            sealed(angles),
            tuple(k in (0, last) or bool(mask >> hinge & 1) for hinge in range(3)),
            (("b", "stroke" if k % 2 else "relax"),),
            passed,
        )
        for k, (time, (_, angles, mask, passed)) in enumerate(zip(times, rows, strict=True))
    )
    motion = condition(keys, JOINT_LIMITS)
    for peak in check_limits(motion.trajectory, JOINT_LIMITS).by_quantity.values():
        assert peak.ratios.max() <= 1.001
    met = motion.trajectory.sample(motion.planned + motion.trajectory.zero)[0]
    for k, key in enumerate(keys):
        for hinge in np.flatnonzero(key.keyed):
            assert abs(met[k, hinge] - key.angles[hinge]) <= 1.01e-3  # Keys at a range end keep a margin to turn back
    for hinge in range(3):
        own = [k for k, key in enumerate(keys) if key.keyed[hinge]]
        assert np.all(np.diff(motion.planned[own]) > 0)

"""Secondary motion added to a motion keeps every limit."""

import numpy as np
from hypothesis import Phase, given
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.changes import Changes
from kinesic.planning.secondary.offset_bumps import OffsetBump
from kinesic.planning.secondary.succession import Delay

from ...examples import examples

# of a trunk, a shoulder and an elbow with common servos
BOX_LIMITS = ([-0.26, -0.87, 0.0], [0.61, 2.97, 2.36], [1.26, 4.44, 6.45], [17.5, 58.9, 80.6])
# duty per acceleration, duty per velocity and duty limit of three hinges
DUTY_LIMITS = ([0.0323, 0.0103, 0.0081], [0.637, 0.18, 0.124], [0.615, 0.654, 0.703])
JOINT_LIMITS = Limits(*(sealed(values) for values in (*BOX_LIMITS, [437.0, 1472.0, 2016.0], *DUTY_LIMITS)))
MIDDLE_ANGLES = (JOINT_LIMITS.lower + JOINT_LIMITS.upper) / 2
MOTION_DURATION = 2.0  # [s] duration of a motion, longer than every reach in it
ROUNDING_RATIO = 1e-8  # rounding error relative to a limit
reaches = st.lists(
    st.tuples(st.integers(1, 9), st.integers(1, 4), st.sampled_from([-1.0, 1.0])), min_size=2, max_size=8
)
sizes = st.floats(-5.0, -0.7).map(lambda power: 10.0**power)  # [rad]
away = st.lists(st.tuples(st.sampled_from([-1.0, 1.0]), sizes).map(np.prod), min_size=3, max_size=3)


@st.composite
def motions(draw):
    """Draw reaches between rests that often reach the jerk limit."""
    jerks = np.zeros((round(MOTION_DURATION / KNOT_INTERVAL), len(JOINT_LIMITS.lower)))
    for hinge in range(len(JOINT_LIMITS.lower)):
        reach = [np.repeat([0.0, sign, -sign, sign], [gap, k, 2 * k, k]) for gap, k, sign in draw(reaches)]
        row = np.concatenate(reach)
        jerks[: len(row), hinge] = row
    controls = np.zeros((len(jerks) + 3, len(JOINT_LIMITS.lower)))
    controls[3:] = np.cumsum(np.cumsum(np.cumsum(jerks * JOINT_LIMITS.jerk * KNOT_INTERVAL**3, axis=0), axis=0), axis=0)
    return Trajectory(
        sealed(MIDDLE_ANGLES + controls / max(1.0, largest(Trajectory(sealed(MIDDLE_ANGLES + controls), 0.0)))), 0.0
    )


@st.composite
def changes(draw, motion):
    """Draw a smooth offset of some hinges or a delayed hinge."""
    jumps = np.flatnonzero(np.abs(np.diff(motion.controls, 4, axis=0)).max(axis=1)) * KNOT_INTERVAL
    begin = draw(st.sampled_from(jumps.tolist())) + draw(st.floats(0.01, 0.04))
    middle, end = (begin + draw(st.floats(0.1, 0.5)), begin + draw(st.floats(0.6, 1.5)))
    if draw(st.booleans()):
        return OffsetBump(begin, middle, end, sealed(draw(away)))
    rows = round((end - begin) / KNOT_INTERVAL)
    bump = draw(sizes) * np.sin(np.linspace(0.0, np.pi, rows)) ** draw(st.integers(1, 4))
    return Delay(begin, end, (draw(st.integers(0, 2)),), sealed(bump[:, None]))


def largest(motion: Trajectory) -> float:
    return max(float(peak.ratios.max()) for peak in check_limits(motion, JOINT_LIMITS).by_quantity.values())


@examples(60, phases=[Phase.generate])
@given(motions(), st.data())
def test_motion_changes_scaled_to_limits_never_exceed_joint_limits(motion, data):
    every = data.draw(st.lists(changes(motion), min_size=1, max_size=4))
    laid = Changes(motion, every)
    whole, all_of_them = np.ones(len(every)), np.ones(len(every), dtype=np.bool_)
    amounts = laid.within_limits(whole, all_of_them, JOINT_LIMITS)
    within = max(1.0, largest(motion)) + ROUNDING_RATIO
    assert largest(laid.added(amounts)) <= within
    if largest(laid.added(whole)) <= 1.0:
        assert amounts.tolist() == whole.tolist()
    less = np.arange(len(every)) == data.draw(st.integers(0, len(every) - 1))
    fewer = laid.within_limits(np.where(less, 0.0, amounts), less, JOINT_LIMITS)
    assert np.all(fewer <= amounts)
    assert largest(laid.added(fewer)) <= within

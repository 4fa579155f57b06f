"""Rests of an arm between its strokes."""

from math import inf

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.arm_times import ArmStroke, Gap, _gaps

START = 5.0  # [s]


def moving(*spans: tuple[int, int], count: int = 100) -> Trajectory:
    """Return a motion of one joint that moves between the control points of each span."""
    steps = np.zeros(count)
    for begin, end in spans:
        steps[begin:end] = 0.01
    return Trajectory(sealed(np.cumsum(steps)[:, None]), START, START)


def test_rest_between_two_arm_strokes_lasts_from_the_end_to_the_start_of_motion():
    motion = moving((30, 50), (70, 90))
    times = np.arange(START, motion.end, KNOT_INTERVAL / 50)
    is_moving = np.abs(motion.sample(times)[1][:, 0]) > 1e-6
    edges = times[1:][np.diff(is_moving.astype(int)) != 0]
    middle = float(edges[1] + edges[2]) / 2
    strokes = [ArmStroke("a", edges[0] + 0.1, edges[1] - 0.1), ArmStroke("b", edges[2] + 0.1, edges[3] - 0.1)]
    before, between, after = _gaps(motion, [0], strokes)
    assert (before.begin, before.end, before.rests[0][0]) == (-inf, strokes[0].begin, -inf)
    assert (after.begin, after.end, after.rests[-1][1]) == (strokes[1].end, inf, inf)
    assert (between.begin, between.end) == (strokes[0].end, strokes[1].begin)
    ((rest_begin, rest_end),) = between.rests
    assert rest_begin < middle < rest_end
    rests = [before.rests[0][1], rest_begin, rest_end, after.rests[-1][0]]
    np.testing.assert_allclose(rests, edges, atol=2.1 * KNOT_INTERVAL)
    assert np.mean(np.array(rests) - edges) == pytest.approx(0.0, abs=KNOT_INTERVAL)


def test_short_standstill_of_an_arm_does_not_count_as_rest():
    motion = moving((30, 50), (51, 70))
    (_, after) = _gaps(motion, [0], [ArmStroke("a", START, START + 0.2)])
    assert len(after.rests) == 2
    assert after.rests[-1][1] == inf


@pytest.mark.parametrize(
    ("gap", "way"),
    [
        (Gap(1.0, 5.0, ()), None),
        (Gap(1.0, 5.0, ((2.0, 3.0),)), None),
        (Gap(1.0, inf, ((2.0, inf),)), (1.0, 2.0)),
        (Gap(1.0, 5.0, ((2.0, 3.0), (4.0, 4.5))), (3.0, 4.0)),
    ],
)
def test_return_path_of_a_gap_ends_at_the_start_of_its_last_rest(gap: Gap, way: tuple[float, float] | None):
    assert gap.return_span == way

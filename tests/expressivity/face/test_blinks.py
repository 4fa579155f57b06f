import numpy as np
import pytest

from kinesic.expressivity.face.blinks import (
    BLINK_WINDOW,
    MAX_WINDOW_BLINKS,
    MIN_BLINK_INTERVAL,
    blink_times,
    blink_units,
)
from kinesic.expressivity.face.eyes import GazeDirection

SAMPLE_TIMES = np.arange(0.0, 10.0, 0.005)


def test_random_blinks_have_a_mean_interval_of_3_to_5_s_and_depend_on_the_seed():
    begins = np.array(blink_times((0.0, 4000.0), (), 3))
    gaps = np.diff(begins)
    assert gaps.min() >= MIN_BLINK_INTERVAL - 1e-9
    assert 3.0 < gaps.mean() < 5.0
    assert blink_times((0.0, 4000.0), (), 3) == tuple(begins)
    assert blink_times((0.0, 4000.0), (), 4) != tuple(begins)


def test_random_blinks_of_a_longer_block_begin_like_those_of_a_shorter_block():
    short, long = (blink_times((0.0, end), (), 5) for end in (30.0, 60.0))
    assert long[: len(short)] == short


def test_wide_gaze_shifts_cause_a_blink_and_small_ones_do_not():
    wide, narrow = GazeDirection(3.0, 0.6, 0.0, 6.0), GazeDirection(3.0, 0.1, 0.0, 6.0)
    assert {3.0, 6.0} <= set(blink_times((0.0, 10.0), [wide], 1))
    assert not {3.0, 6.0} & set(blink_times((0.0, 10.0), [narrow], 1))


def test_requested_blink_occurs_unless_another_blink_is_too_close():
    assert {2.0, 4.0} <= set(blink_times((0.0, 10.0), (), 1, also=[2.0, 2.5, 4.0]))
    assert 2.5 not in blink_times((0.0, 10.0), (), 1, also=[2.0, 2.5, 4.0])


def test_blink_closes_both_eyes_fully_and_lasts_0_14_to_0_38_s():
    units = blink_units([2.0], SAMPLE_TIMES)
    assert units.keys() == {"L45", "R45"}
    closed = units["L45"]
    assert closed.max() == 1.0
    shown = SAMPLE_TIMES[closed > 0.0]
    assert 2.0 < shown.min() < 2.02
    assert 0.14 < np.ptp(shown) < 0.38


def test_blink_durations_vary_and_do_not_depend_on_later_blinks():
    times = np.arange(0.0, 120.0, 0.005)
    begins = np.arange(1.0, 119.0, 2.0)
    closed = blink_units(begins, times, 3)["L45"]
    lengths = np.array([np.sum(closed[(times >= b) & (times < b + 1.0)] > 0.3) * 0.005 for b in begins])
    assert lengths.min() >= 0.09
    assert lengths.max() <= 0.30
    assert lengths.std() > 0.02
    np.testing.assert_array_equal(blink_units(begins[:5], times, 3)["L45"][times < 10.0], closed[times < 10.0])
    assert np.any(blink_units(begins, times, 4)["L45"] != closed)


def test_blinks_requested_every_0_3_s_keep_their_minimum_interval_and_maximum_rate():
    begins = np.array(blink_times((0.0, 60.0), (), 3, also=np.arange(0.1, 60.0, 0.3).tolist()))
    assert begins[0] == pytest.approx(0.1)
    assert np.diff(begins).min() >= MIN_BLINK_INTERVAL - 1e-9
    assert np.min(begins[MAX_WINDOW_BLINKS:] - begins[:-MAX_WINDOW_BLINKS]) >= BLINK_WINDOW - 1e-9
    assert 15 <= len(begins) <= 21
    assert blink_times((5.0, 6.0), (), 3, also=[4.9, 6.0, 6.1]) == blink_times((5.0, 6.0), (), 3)


@pytest.mark.parametrize("causes", [[], np.arange(0.5, 3600.0, 2.9).tolist(), np.arange(3.0, 3600.0, 11.0).tolist()])
def test_eyes_blink_10_to_25_times_in_every_minute(causes):
    begins = np.array(blink_times((0.0, 3600.0), (), 7, also=causes))
    counts = [np.sum((begins >= first) & (begins < first + 60.0)) for first in np.arange(0.0, 3540.0, 5.0)]
    assert min(counts) >= 10
    assert max(counts) <= 25

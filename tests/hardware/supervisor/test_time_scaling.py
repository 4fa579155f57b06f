import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.supervisor.time_scaling import TimeScale, advance_time

STEP = 0.01


def run(tempo: TimeScale, steps: int, *, wanted: float = 1.0, end: float = 100.0, slow: float = 0.4) -> list[TimeScale]:
    told = [tempo]
    for _ in range(steps):
        told.append(advance_time(told[-1], STEP, wanted=wanted, end=end, slow=slow))
    return told


def test_full_speed_is_reached_evenly_and_kept():
    told = run(TimeScale(), 100)
    assert np.allclose(np.diff([each.scale for each in told[:41]]), STEP / 0.4)
    assert told[-1].scale == 1.0
    assert np.isclose(told[-1].time - told[-2].time, STEP)


def test_it_stops_in_the_time_that_is_given():
    told = run(TimeScale(1.0, 1.0), 41, wanted=0.0)
    assert told[39].scale > 0.0
    assert told[41].still


def test_it_stops_softly_where_nothing_more_is_known():
    told = run(TimeScale(0.0, 1.0), 400, end=1.0)
    assert told[-1] == TimeScale(1.0, 0.0)
    assert max(np.abs(np.diff([each.scale for each in told]))) <= STEP / 0.4 + 1e-9


@given(
    st.floats(0, 1),
    st.floats(0.02, 1),
    st.lists(st.tuples(st.floats(0, 1), st.floats(-0.2, 3)), min_size=1, max_size=50),
)
def test_time_never_goes_back_nor_beyond_the_end(scale: float, slow: float, story: list[tuple[float, float]]):
    tempo, end = TimeScale(0.0, scale), 0.0
    for wanted, more in story:
        end = max(end, tempo.time + more)
        after = advance_time(tempo, STEP, wanted=wanted, end=end, slow=slow)
        assert tempo.time <= after.time <= max(end, tempo.time)
        assert after.time - tempo.time <= STEP + 1e-12
        assert 0.0 <= after.scale <= 1.0
        tempo = after

"""Silent servos are read again within 0.2 s of an answer."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault

from ...hardware.conftest import rig_of

MAX_DELAY = 0.2  # [s] longest time from the end of a silence to the first accepted record
MID_TICKS, SERVO_COUNT = 2048, 7

silences = st.lists(
    st.tuples(st.sets(st.integers(1, SERVO_COUNT), min_size=1, max_size=3), st.integers(1, 80), st.integers(0, 300)),
    min_size=1,
    max_size=8,
)


def delays(silences, builder: str, *faults: PlannedFault, latency: float = 0.001) -> list[float]:
    """Measure the time [s] from each silence's end to a complete reading."""
    made = rig_of(SERVO_COUNT, servos=builder, latency=latency, faults=FaultPlan(faults, seed=1))
    made.energise()
    results = []
    for silent, cycles, moved in silences:
        places = [k - 1 for k in silent]
        _mute(made, places, mute=True)
        made.run(cycles, np.full(SERVO_COUNT, MID_TICKS + moved))
        _mute(made, places, mute=False)
        waiting, ended = set(places), made.wire.now()
        while waiting and made.wire.now() < ended + 2 * MAX_DELAY:
            (cycle,) = made.run(1, np.full(SERVO_COUNT, MID_TICKS + moved))
            waiting -= set(np.flatnonzero(cycle.fresh | cycle.late).tolist())
        results.append(made.wire.now() - ended)
        made.run(3, np.full(SERVO_COUNT, MID_TICKS))
    return results


def _mute(made, places, *, mute: bool) -> None:
    for place in places:
        made.plant.servos[place].mute = mute


@settings(max_examples=settings.default.max_examples // 3)
@given(silences, st.sampled_from(("kinesic", "manual")), st.sampled_from((0.001, 0.004)))
def test_silent_servos_are_read_within_0_2_s_after_they_answer_again(silences, builder, latency) -> None:
    assert max(delays(silences, builder, latency=latency)) <= MAX_DELAY


@settings(max_examples=settings.default.max_examples // 6)
@given(st.lists(st.tuples(st.just({3}), st.integers(6, 60), st.just(0)), min_size=3, max_size=8))
def test_silent_servo_with_late_replies_is_read_within_0_2_s(silences) -> None:
    late = PlannedFault("late", (3,), rate=1.0, start=0.3, value=0.006)
    assert max(delays(silences, "kinesic", late)) <= MAX_DELAY

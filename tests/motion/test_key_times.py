from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.blocks import write_overlapping_block
from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import key_times
from kinesic.motion.budget import Budget
from kinesic.motion.condition import condition
from kinesic.motion.double_s import compute_rest_durations, compute_velocity_durations
from kinesic.motion.infeasibility import measure_time_deficit
from kinesic.motion.key_time_lp import shift_cost
from kinesic.motion.key_times import KeyTimeSearch
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import segments
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.session.plan import plan

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def keys_of(*rows: tuple[float, float, str]) -> tuple[KeyPosture, ...]:
    return tuple(KeyPosture(time, sealed([angle]), (True,), (("b", sync),)) for time, angle, sync in rows)


def tune(monkeypatch: pytest.MonkeyPatch, **changes: float) -> None:
    monkeypatch.setattr(key_times, "SEARCH_TUNING", replace(key_times.SEARCH_TUNING, **changes))


@pytest.mark.parametrize("distance", [0.0, 0.002, 0.05, 0.4, 1.9, 3.9])
def test_rest_to_rest_durations_are_feasible_and_full_velocity_durations_are_lower_bounds(distance):
    def ends(duration: float) -> tuple[KeyPosture, ...]:
        return keys_of((0, -1.95, "start"), (duration, -1.95 + distance, "stroke"))

    keys = Keys.of(ends(1.0), JOINT_LIMITS)
    enough, least = (
        compute_rest_durations(keys, JOINT_LIMITS)[0, (0, 1)],
        compute_velocity_durations(keys, JOINT_LIMITS)[0, (0, 1)],
    )
    np.testing.assert_array_equal(condition(ends(enough), JOINT_LIMITS).planned, [0.0, enough])
    assert least <= enough
    if distance > 0.01:
        short = condition(ends(0.7 * enough - 0.04), JOINT_LIMITS, lead_in=0.0)
        assert least < short.planned[1] < 1.1 * enough


def test_minimum_durations_are_computed_for_each_key_interval():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "stroke"), (2, 1, "end")), JOINT_LIMITS)
    assert set(compute_rest_durations(keys, JOINT_LIMITS)) == {(0, (0, 1)), (0, (1, 2))}
    assert compute_velocity_durations(keys, JOINT_LIMITS) == {(0, (0, 1)): pytest.approx(0.25), (0, (1, 2)): 0.0}


def test_lower_duty_limit_increases_minimum_durations():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "stroke")), JOINT_LIMITS)
    tight = replace(JOINT_LIMITS, duty=sealed([0.35]))
    for times in (compute_rest_durations, compute_velocity_durations):
        assert times(keys, tight)[0, (0, 1)] > 1.2 * times(keys, JOINT_LIMITS)[0, (0, 1)]
    assert compute_velocity_durations(keys, tight)[0, (0, 1)] == pytest.approx(0.15 / 0.35)


FEASIBLE_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
# key time [s], angles of both hinges [rad] and sync point
HURRIED_ROWS = (
    (0, 0, 0, "start"),
    (0.4, 0.6, 0, "ready"),
    (0.6, -0.6, 1, "stroke"),
    (0.8, 0.6, 1, "relax"),
    (2, 0, 0, "end"),
)
# key postures with too little time
HURRIED_KEYS = tuple(KeyPosture(time, sealed(turn), (True, True), (("b", sync),)) for time, *turn, sync in HURRIED_ROWS)


def find_infeasible(search: KeyTimeSearch, keys: Keys):
    moving = [segment for segment in segments(search.times, keys, KNOT_INTERVAL) if not segment.is_still]
    return [segment for segment in moving if measure_time_deficit(segment, FEASIBLE_LIMITS).amount > 0.0]


def test_key_time_search_starts_from_full_velocity_durations():
    keys = Keys.of(HURRIED_KEYS, FEASIBLE_LIMITS)
    search = KeyTimeSearch(keys, FEASIBLE_LIMITS, 0.6)
    assert search.times[2] - search.times[1] == pytest.approx(0.3)
    assert search.bottlenecks[1, 2].quantity == "speed"
    assert search.bottlenecks[1, 2].ratio == pytest.approx(1.5)


def test_key_time_search_gives_an_infeasible_segment_more_time():
    keys = Keys.of(HURRIED_KEYS, FEASIBLE_LIMITS)
    search = KeyTimeSearch(keys, FEASIBLE_LIMITS, 0.6)
    infeasible = find_infeasible(search, keys)
    assert infeasible
    search.resolve(infeasible[0])
    assert not find_infeasible(search, keys)


def test_segment_with_unknown_time_deficit_gets_rest_to_rest_durations():
    keys = Keys.of(HURRIED_KEYS, FEASIBLE_LIMITS)
    search = KeyTimeSearch(keys, FEASIBLE_LIMITS, 0.6)
    segment = find_infeasible(search, keys)[0]
    search._request_more_time(segment, None)
    durations = compute_rest_durations(keys, FEASIBLE_LIMITS)
    assert all(search._gaps[pair] >= durations[hinge, pair] for hinge, pair in segment.key_intervals)


def test_feasible_requested_key_times_are_unchanged():
    slow = tuple(replace(key, time=3 * key.time) for key in HURRIED_KEYS)
    keys = Keys.of(slow, FEASIBLE_LIMITS)
    np.testing.assert_array_equal(KeyTimeSearch(keys, FEASIBLE_LIMITS, 0.6).times, keys.requested_times)


def test_key_time_search_fails_with_the_hinge_name_if_a_segment_stays_infeasible(monkeypatch):
    """Report the first segment as infeasible a hundred times."""
    tune(monkeypatch, max_rest_factor=10.0)  # the longer a motion, the slower is each look at it
    keys = Keys.of(HURRIED_KEYS, FEASIBLE_LIMITS)
    search = KeyTimeSearch(keys, FEASIBLE_LIMITS, 0.6)
    began = search.times

    def report_repeatedly() -> None:
        for _ in range(100):
            search.resolve(next(segments(search.times, keys, KNOT_INTERVAL)))

    with pytest.raises(ArithmeticError, match="hinge 0 cannot move"):
        report_repeatedly()
    assert search.times[-1] - search.times[0] > 2 * (began[-1] - began[0])


def test_motion_with_a_low_duty_limit_takes_long_and_reports_duty_as_bottleneck():
    weak = replace(FEASIBLE_LIMITS, duty=sealed([0.06, 0.06]))
    motion = condition(HURRIED_KEYS, weak)
    assert motion.planned[-1] > 10.0
    assert {bottleneck.quantity for bottleneck in motion.bottlenecks.values()} == {"duty"}


def nods(count: int, seconds: float) -> Keys:
    """Return keys of a number of there-and-back movements within a time [s]."""
    turns = [0.0, *(0.35 * (k % 2) for k in range(2 * count + 1)), 0.0]
    times = [0.0, *(0.3 + seconds * k / (2 * count) for k in range(2 * count + 1)), seconds + 0.5]
    names = ["start", *("relax" if k % 2 == 0 else f"stroke:{k}" for k in range(2 * count + 1)), "end"]
    return Keys.of(keys_of(*zip(times, turns, names, strict=True)), SLOW_LIMITS)


# limits with a duty limit that requires slow motion
SLOW_LIMITS = Limits(
    *(sealed([value]) for value in (-2, 2, 6, 40, 1e3, 0.01, 0.05, 0.5))
)  # limits of one hinge, with a duty limit that requires slow motion


def test_repeated_strokes_take_less_time_than_rest_to_rest_moves():
    keys = nods(6, 1.9)
    motion = condition(
        keys_of(*zip(keys.requested_times, keys.angles[:, 0], [s[0][1] for s in keys.syncs], strict=True)), SLOW_LIMITS
    )
    rests = compute_rest_durations(keys, SLOW_LIMITS)
    gaps = np.diff(motion.planned)[1:-1]
    assert motion.planned[-2] - motion.planned[1] > 1.95
    assert gaps.sum() < 0.8 * sum(rests[0, (k, k + 1)] for k in range(1, len(gaps) + 1))


def test_at_least_half_of_the_key_intervals_get_rest_to_rest_durations_if_stretching_fails(monkeypatch):
    monkeypatch.setattr(key_times, "stretch_until_enough", lambda *given: None)
    tune(monkeypatch, max_planes=0)
    keys = nods(6, 1.9)
    postures = keys_of(*zip(keys.requested_times, keys.angles[:, 0], [s[0][1] for s in keys.syncs], strict=True))
    planned, rests = condition(postures, SLOW_LIMITS).planned, compute_rest_durations(keys, SLOW_LIMITS)
    resting = sum(planned[j] - planned[i] >= 0.999 * rest for (_, (i, j)), rest in rests.items())
    assert resting >= len(rests) / 2, "hinges rest where they are short"
    assert planned[-1] - planned[0] <= 1.01 * sum(rests.values())


def write_rapid_head_block(gap: float, strokes: int = 6) -> tuple[KeyPosture, ...]:
    """Return keys of repeated head strokes with equal short gaps [s]."""
    turns = [
        (0.3, "ready"),
        *(way for k in range(strokes) for way in ((-0.3, f"strokeStart:{k}"), (0.3, f"stroke:{k + 1}"))),
    ]
    rows = [(gap * k, turn, sync) for k, (turn, sync) in enumerate(turns, 1)]
    return keys_of((0.0, 0.0, "start"), *rows, (gap * (len(turns) + 1), 0.0, "end"))


def measured(monkeypatch) -> list[int]:
    """Record the hinge of each later measurement of a time deficit."""
    seen: list[int] = []

    def measure(segment, limits, **options):
        seen.append(segment.hinge)
        return measure_time_deficit(segment, limits, **options)

    monkeypatch.setattr(key_times, "measure_time_deficit", measure)
    return seen


@pytest.mark.parametrize("gap", [0.15, pytest.param(0.2, marks=pytest.mark.soak)])
def test_stretching_repeated_strokes_needs_few_measurements_and_costs_no_more_than_planes(gap, monkeypatch):
    """Compare with cutting planes, which need far more measurements."""
    seen = measured(monkeypatch)
    motion = condition(write_rapid_head_block(gap), JOINT_LIMITS)
    assert len(seen) <= 10
    tune(monkeypatch, min_repeats=100)
    assert shift_cost(Keys.of(write_rapid_head_block(gap), JOINT_LIMITS), motion.planned) <= shift_cost(
        Keys.of(write_rapid_head_block(gap), JOINT_LIMITS), condition(write_rapid_head_block(gap), JOINT_LIMITS).planned
    )
    assert len(seen) > 40


def test_cutting_planes_find_times_below_rest_to_rest_durations_without_stretching(monkeypatch):
    monkeypatch.setattr(key_times, "stretch_until_enough", lambda *given: None)
    keys = Keys.of(write_rapid_head_block(0.2, strokes=3), JOINT_LIMITS)
    tune(monkeypatch, max_planes=10**6)
    search = KeyTimeSearch(keys, JOINT_LIMITS, 0.6)
    search.resolve(next(segment for segment in segments(search.times, keys, KNOT_INTERVAL) if not segment.is_still))
    rests = compute_rest_durations(keys, JOINT_LIMITS)
    assert search.times[-1] - search.times[0] < 0.9 * sum(rests.values())


@pytest.mark.parametrize(("seeds", "most"), [((7, 9), 77), ((2,), 10)])
def test_number_of_time_deficits_measured_for_overlapping_gestures_is_bounded(seeds, most, known, monkeypatch):
    """Detect superfluous measurements, such as of unaffected neighbouring segments."""
    seen, hands_alone = measured(monkeypatch), replace(known, style=known.style.changed(["whole_body=0"]))
    for seed in seeds:
        plan(write_overlapping_block(seed, ["beat", "offer", "large"]), hands_alone)
    assert len(seen) <= most


def test_exceeded_evaluation_limit_ends_measurements_with_rest_to_rest_durations(monkeypatch):
    """Reduce the limit below the work of the first segment."""
    seen = measured(monkeypatch)
    keys = nods(6, 1.9)
    postures = keys_of(*zip(keys.requested_times, keys.angles[:, 0], [s[0][1] for s in keys.syncs], strict=True))
    condition(postures, SLOW_LIMITS)
    assert len(seen) > 3
    seen.clear()
    tune(monkeypatch, max_evaluations=100)  # fewer pieces than the first segment has
    planned = condition(postures, SLOW_LIMITS).planned
    assert len(seen) == 1
    assert all(
        planned[j] - planned[i] >= 0.999 * rest
        for (_, (i, j)), rest in compute_rest_durations(keys, SLOW_LIMITS).items()
    )


def test_spent_budget_gives_rest_to_rest_durations_without_measurements(monkeypatch):
    seen = measured(monkeypatch)
    keys = nods(6, 1.9)
    postures = keys_of(*zip(keys.requested_times, keys.angles[:, 0], [s[0][1] for s in keys.syncs], strict=True))
    planned = condition(postures, SLOW_LIMITS, budget=Budget(-1.0)).planned
    assert seen == []
    assert all(
        planned[j] - planned[i] >= 0.999 * rest
        for (_, (i, j)), rest in compute_rest_durations(keys, SLOW_LIMITS).items()
    )


def test_time_deficits_of_segments_among_very_many_keys_are_measurable(known, monkeypatch):
    """Plan a block of all gestures, whose deficits must all be measured."""
    deficits = []

    def measure(*given, **options):
        deficits.append(measure_time_deficit(*given, **options))
        return deficits[-1]

    monkeypatch.setattr(key_times, "measure_time_deficit", measure)
    plan(write_overlapping_block(102, [form.id for form in known.lexicon.forms]), known)
    assert len(deficits) > 20
    assert all(deficits)


def test_segments_with_unchanged_key_times_come_from_the_cache():
    search = KeyTimeSearch(Keys.of(HURRIED_KEYS, FEASIBLE_LIMITS), FEASIBLE_LIMITS, 0.6)
    first, second = ([*search._find_segments(search.times)] for _ in range(2))
    assert first
    assert all(one is other for one, other in zip(first, second, strict=True))
    moved = [*search._find_segments(search.times + np.array([0.0, 0.0, 0.02, 0.0, 0.0]))]
    assert not any(one is other for one in first for other in moved)


def test_long_motion_is_allowed_more_evaluations_than_a_short_one():
    def allowed(seconds: float) -> float:
        keys = Keys.of(keys_of((0.0, 0.0, "start"), (seconds, 0.1, "end")), SLOW_LIMITS)
        return KeyTimeSearch(keys, SLOW_LIMITS, lead_in=0.0)._max_evaluations

    assert allowed(5.0) == key_times.SEARCH_TUNING.max_evaluations
    assert allowed(60.0) == 4.0 * key_times.SEARCH_TUNING.max_evaluations

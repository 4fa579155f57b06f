from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.blocks import crowd
from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.controller.perform import plan
from kinesic.motion import key_times
from kinesic.motion.budget import Budget
from kinesic.motion.condition import condition
from kinesic.motion.double_s import full_speed, rest_to_rest
from kinesic.motion.infeasibility import measure_shortage
from kinesic.motion.key_time_lp import strain
from kinesic.motion.key_times import Search
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import segments
from kinesic.motion.trajectory import STEP

LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def keys_of(*rows: tuple[float, float, str]) -> tuple[KeyPosture, ...]:
    return tuple(KeyPosture(time, sealed([angle]), (True,), (("b", sync),)) for time, angle, sync in rows)


@pytest.mark.parametrize("distance", [0.0, 0.002, 0.05, 0.4, 1.9, 3.9])
def test_from_rest_to_rest_is_enough_and_full_speed_is_not(distance):
    def ends(duration: float) -> tuple[KeyPosture, ...]:
        return keys_of((0, -1.95, "start"), (duration, -1.95 + distance, "stroke"))

    keys = Keys.of(ends(1.0), LIMITS)
    enough, least = rest_to_rest(keys, LIMITS)[0, (0, 1)], full_speed(keys, LIMITS)[0, (0, 1)]
    np.testing.assert_array_equal(condition(ends(enough), LIMITS).planned, [0.0, enough])
    assert least <= enough
    if distance > 0.01:
        short = condition(ends(0.7 * enough - 0.04), LIMITS, lead_in=0.0)
        assert least < short.planned[1] < 1.1 * enough


def test_all_ways_of_a_hinge_are_known():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "stroke"), (2, 1, "end")), LIMITS)
    assert set(rest_to_rest(keys, LIMITS)) == {(0, (0, 1)), (0, (1, 2))}
    assert full_speed(keys, LIMITS) == {(0, (0, 1)): pytest.approx(0.25), (0, (1, 2)): 0.0}


def test_a_tighter_duty_takes_longer():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "stroke")), LIMITS)
    tight = replace(LIMITS, duty=sealed([0.35]))
    for times in (rest_to_rest, full_speed):
        assert times(keys, tight)[0, (0, 1)] > 1.2 * times(keys, LIMITS)[0, (0, 1)] or times is full_speed
    assert full_speed(keys, tight)[0, (0, 1)] == pytest.approx(0.15 / 0.35)


FEASIBLE_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
ROWS = ((0, 0, 0, "start"), (0.4, 0.6, 0, "ready"), (0.6, -0.6, 1, "stroke"), (0.8, 0.6, 1, "relax"), (2, 0, 0, "end"))
KEYS = tuple(KeyPosture(time, sealed(turn), (True, True), (("b", sync),)) for time, *turn, sync in ROWS)


def lacking(search: Search, keys: Keys):
    found = [segment for segment in segments(search.times, keys, STEP) if not segment.still]
    return [segment for segment in found if measure_shortage(segment, FEASIBLE_LIMITS).amount > 0.0]


def test_it_begins_at_full_speed():
    keys = Keys.of(KEYS, FEASIBLE_LIMITS)
    search = Search(keys, FEASIBLE_LIMITS, 0.6)
    assert search.times[2] - search.times[1] == pytest.approx(0.3)
    assert search.met[1, 2].quantity == "speed"
    assert search.met[1, 2].ratio == pytest.approx(1.5)


def test_what_lacks_time_is_given_time():
    keys = Keys.of(KEYS, FEASIBLE_LIMITS)
    search = Search(keys, FEASIBLE_LIMITS, 0.6)
    lost = lacking(search, keys)
    assert lost
    search.avoid(lost[0])
    assert not lacking(search, keys)


def test_asked_times_that_suffice_are_not_touched():
    slow = tuple(replace(key, time=3 * key.time) for key in KEYS)
    keys = Keys.of(slow, FEASIBLE_LIMITS)
    np.testing.assert_array_equal(Search(keys, FEASIBLE_LIMITS, 0.6).times, keys.asked)


def test_a_segment_that_is_lost_whatever_is_known_rests_in_the_end(monkeypatch):
    """As if no program were ever solved: times grow, and in the end somebody is named."""
    monkeypatch.setattr(key_times, "LONGEST", 10.0)  # the longer a motion, the slower is each look at it
    keys = Keys.of(KEYS, FEASIBLE_LIMITS)
    search = Search(keys, FEASIBLE_LIMITS, 0.6)
    began = search.times

    def lose() -> None:
        for _ in range(100):
            search.avoid(next(segments(search.times, keys, STEP)))

    with pytest.raises(ArithmeticError, match="hinge 0 cannot move"):
        lose()
    assert search.times[-1] - search.times[0] > 2 * (began[-1] - began[0])


def test_a_hinge_that_can_hardly_move_takes_long():
    weak = replace(FEASIBLE_LIMITS, duty=sealed([0.06, 0.06]))
    motion = condition(KEYS, weak)
    assert motion.planned[-1] > 10.0
    assert {met.quantity for met in motion.bottlenecks.values()} == {"duty"}


def nods(count: int, seconds: float) -> Keys:
    """A hinge that goes there and back so many times, in a time."""
    turns = [0.0, *(0.35 * (k % 2) for k in range(2 * count + 1)), 0.0]
    times = [0.0, *(0.3 + seconds * k / (2 * count) for k in range(2 * count + 1)), seconds + 0.5]
    names = ["start", *("relax" if k % 2 == 0 else f"stroke:{k}" for k in range(2 * count + 1)), "end"]
    return Keys.of(keys_of(*zip(times, turns, names, strict=True)), SLOW)


SLOW = Limits(*(sealed([value]) for value in (-2, 2, 6, 40, 1e3, 0.01, 0.05, 0.5)))


def test_repeated_strokes_do_not_rest_at_each_turn():
    keys = nods(6, 1.9)
    motion = condition(keys_of(*zip(keys.asked, keys.angles[:, 0], [s[0][1] for s in keys.syncs], strict=True)), SLOW)
    rests = rest_to_rest(keys, SLOW)
    gaps = np.diff(motion.planned)[1:-1]
    assert motion.planned[-2] - motion.planned[1] > 1.95
    assert gaps.sum() < 0.8 * sum(rests[0, (k, k + 1)] for k in range(1, len(gaps) + 1))


def test_what_no_stretch_leads_to_rests(monkeypatch):
    monkeypatch.setattr(key_times, "stretch_until_enough", lambda *given: None)
    monkeypatch.setattr(key_times, "PLANES", 0)
    keys = nods(6, 1.9)
    postures = keys_of(*zip(keys.asked, keys.angles[:, 0], [s[0][1] for s in keys.syncs], strict=True))
    planned, rests = condition(postures, SLOW).planned, rest_to_rest(keys, SLOW)
    resting = sum(planned[j] - planned[i] >= 0.999 * rest for (_, (i, j)), rest in rests.items())
    assert resting >= len(rests) / 2, "hinges rest where they are short"
    assert planned[-1] - planned[0] <= 1.01 * sum(rests.values())


def rhythm(gap: float, strokes: int = 6) -> tuple[KeyPosture, ...]:
    """Strokes to and fro, all in the same short time."""
    turns = [
        (0.3, "ready"),
        *(way for k in range(strokes) for way in ((-0.3, f"strokeStart:{k}"), (0.3, f"stroke:{k + 1}"))),
    ]
    rows = [(gap * k, turn, sync) for k, (turn, sync) in enumerate(turns, 1)]
    return keys_of((0.0, 0.0, "start"), *rows, (gap * (len(turns) + 1), 0.0, "end"))


def measured(monkeypatch) -> list[int]:
    """Hinges whose shortage is measured from now on."""
    seen: list[int] = []

    def measure(segment, limits, **options):
        seen.append(segment.hinge)
        return measure_shortage(segment, limits, **options)

    monkeypatch.setattr(key_times, "measure_shortage", measure)
    return seen


@pytest.mark.parametrize("gap", [0.15, pytest.param(0.2, marks=pytest.mark.soak)])
def test_repeated_strokes_are_stretched_at_once(gap, monkeypatch):
    """Planes take forty rounds and find no better times."""
    seen = measured(monkeypatch)
    motion = condition(rhythm(gap), LIMITS)
    assert len(seen) <= 10
    monkeypatch.setattr(key_times, "REPEATS", 100)
    assert strain(Keys.of(rhythm(gap), LIMITS), motion.planned) <= strain(
        Keys.of(rhythm(gap), LIMITS), condition(rhythm(gap), LIMITS).planned
    )
    assert len(seen) > 40


def test_planes_do_what_a_stretch_cannot(monkeypatch):
    monkeypatch.setattr(key_times, "stretch_until_enough", lambda *given: None)
    keys = Keys.of(rhythm(0.2, strokes=3), LIMITS)
    monkeypatch.setattr(key_times, "PLANES", 10**6)
    search = Search(keys, LIMITS, 0.6)
    search.avoid(next(segment for segment in segments(search.times, keys, STEP) if not segment.still))
    rests = rest_to_rest(keys, LIMITS)
    assert search.times[-1] - search.times[0] < 0.9 * sum(rests.values())


@pytest.mark.parametrize(("seeds", "most"), [((1, 5, 7, 9), 185), ((2,), 10)])
def test_what_is_short_is_looked_at_before_what_is_near(seeds, most, known, monkeypatch):
    """To measure all that is near in every round, or beside any plane of its hinge, takes a fifth more."""
    seen, hands_alone = measured(monkeypatch), replace(known, style=known.style.changed(["whole_body=0"]))
    for seed in seeds:
        plan(crowd(seed, ["beat", "offer", "large"]), hands_alone)
    assert len(seen) <= most


def test_what_is_measured_is_counted_and_hinges_rest_when_the_budget_is_spent(monkeypatch):
    """A count, not a clock: every host finds the same times."""
    seen = measured(monkeypatch)
    keys = nods(6, 1.9)
    postures = keys_of(*zip(keys.asked, keys.angles[:, 0], [s[0][1] for s in keys.syncs], strict=True))
    condition(postures, SLOW)
    assert len(seen) > 3
    seen.clear()
    monkeypatch.setattr(key_times, "LOOKS", 100)  # fewer pieces than the first segment has
    planned = condition(postures, SLOW).planned
    assert len(seen) == 1
    assert all(planned[j] - planned[i] >= 0.999 * rest for (_, (i, j)), rest in rest_to_rest(keys, SLOW).items())


def test_with_its_budget_spent_nothing_is_measured_and_hinges_rest_wherever_they_are_short(monkeypatch):
    seen = measured(monkeypatch)
    keys = nods(6, 1.9)
    postures = keys_of(*zip(keys.asked, keys.angles[:, 0], [s[0][1] for s in keys.syncs], strict=True))
    planned = condition(postures, SLOW, budget=Budget(-1.0)).planned
    assert seen == []
    assert all(planned[j] - planned[i] >= 0.999 * rest for (_, (i, j)), rest in rest_to_rest(keys, SLOW).items())


def test_what_a_crowd_lacks_is_always_found(known, monkeypatch):
    """A program that is not solved makes a hinge rest at its keys, and strokes move far."""
    found = []

    def measure(*given, **options):
        found.append(measure_shortage(*given, **options))
        return found[-1]

    monkeypatch.setattr(key_times, "measure_shortage", measure)
    plan(crowd(102, [form.id for form in known.lexicon.forms]), known)
    assert len(found) > 20
    assert all(found)


def test_segments_of_hinges_whose_times_stay_are_made_once():
    search = Search(Keys.of(KEYS, FEASIBLE_LIMITS), FEASIBLE_LIMITS, 0.6)
    first, again = ([*search._segments(search.times)] for _ in range(2))
    assert first
    assert all(one is other for one, other in zip(first, again, strict=True))
    moved = [*search._segments(search.times + np.array([0.0, 0.0, 0.02, 0.0, 0.0]))]
    assert not any(one is other for one in first for other in moved)

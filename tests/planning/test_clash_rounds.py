"""Tests of timing conflicts resolved per planning round."""

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion.keys import KeyPosture
from kinesic.planning import clashes
from kinesic.planning.clashes import (
    MAX_EXACT_PAIRS,
    NEGLIGIBLE_CLASH,
    SEARCH_BUDGET,
    VISIBLE_CLASH,
    ClashFinder,
    Neighbours,
)

# [s] separation of each pair in a row of gestures a to f
PAIR_SEPARATIONS = {"ab": 0.3, "bc": 0.5, "cd": 0.4, "de": 0.45, "ef": 0.3}


@pytest.fixture
def row(monkeypatch, known):
    """Return a function that makes a clash finder with given lacking times [s]."""

    def of(lacking: dict[str, float], brief: str = "") -> ClashFinder:
        def lack(pair: Neighbours) -> float:
            return lacking["".join(pair.behaviours)]

        every = [Neighbours((a, b), (k, k + 1), (0,), a + b in brief.split()) for k, (a, b) in enumerate(lacking)]
        monkeypatch.setattr(clashes, "_neighbours", lambda *_: every)
        monkeypatch.setattr(
            ClashFinder,
            "_suspects",
            lambda _, coming, __: [(pair, lacking["".join(pair.behaviours)]) for pair in coming],
        )
        monkeypatch.setattr(clashes, "_search", lambda pair, *_: lacking["".join(pair.behaviours)])
        return ClashFinder(known)

    return of


def look(finder: ClashFinder) -> str:
    return "".join(sorted(finder.look(None, ())))


def test_worst_timing_conflict_is_resolved_first_and_those_of_its_neighbours_are_postponed(row):
    finder = row(PAIR_SEPARATIONS)
    assert look(finder) == "bcef"
    assert {"".join(sorted(pair)): clash.delay for pair, clash in finder.clashes.items()} == {"bc": 0.5, "ef": 0.3}


def test_only_every_second_timing_conflict_is_resolved_once_the_budget_is_spent(row):
    finder = row(PAIR_SEPARATIONS)
    finder._budget.spend(2 * SEARCH_BUDGET)
    assert finder.spent
    assert look(finder) == "bcde"


def test_timing_conflict_is_checked_again_after_its_stroke_was_shortened(row):
    finder = row({"ab": 0.5})
    assert look(finder) == "ab"
    assert look(finder) == ""
    (clash,) = finder.clashes.values()
    assert not clash.brief
    brief = row({"ab": 0.5}, brief="ab")
    brief.clashes |= finder.clashes
    assert look(brief) == "ab"
    assert brief.clashes[frozenset("ab")].brief
    assert look(brief) == ""


def test_small_delays_are_a_timing_conflict_only_if_their_sum_is_visible(row):
    assert look(row({"ab": 0.9 * VISIBLE_CLASH})) == ""
    assert look(row({"ab": 1.1 * VISIBLE_CLASH})) == "ab"
    assert look(row({"ab": 0.6 * VISIBLE_CLASH, "bc": 0.7 * VISIBLE_CLASH})) == "bc"
    assert look(row({"ab": 0.9 * NEGLIGIBLE_CLASH, "bc": VISIBLE_CLASH - NEGLIGIBLE_CLASH / 2})) == ""


def test_too_many_candidate_pairs_of_timing_conflicts_end_the_exact_searches(row):
    few = {chr(k) + chr(k + 1): 0.3 for k in range(200, 200 + MAX_EXACT_PAIRS)}
    finder = row(few)
    look(finder)
    assert not finder.crowded
    assert not finder.spent
    finder = row(few | {chr(900) + chr(901): 0.3})
    look(finder)
    assert finder.crowded
    assert finder.spent


def keyed(time: float, *syncs: str, is_exact: bool = True) -> KeyPosture:
    return KeyPosture(time, sealed([0.0]), (True,), tuple((id, "stroke") for id in syncs), (), is_exact)


@pytest.mark.parametrize(
    ("moving", "exact_flags", "around"),
    [
        ("1111111", "1111111", (2, 4)),
        ("1101011", "1111111", (1, 5)),
        ("1111111", "1101011", (1, 5)),
        ("0011100", "1111111", (2, 4)),
        ("0001000", "1111111", (3, 3)),
    ],
)
def test_timing_conflict_search_spans_the_nearest_exact_keys(moving: str, exact_flags: str, around: tuple[int, int]):
    strokes = {2: "a", 4: "b"}
    postures = [keyed(float(k), *strokes.get(k, ""), is_exact=flag == "1") for k, flag in enumerate(exact_flags)]
    own = np.array([item == "1" for item in moving])
    assert clashes._around(Neighbours(("a", "b"), (2, 4), (0,)), postures, own) == around


def test_key_posture_can_be_reduced_to_given_joints():
    whole = KeyPosture(1.5, sealed([0.1, 0.2, 0.3]), (True, False, False), (("a", "stroke"),), (), is_exact=False)
    part = clashes._part(whole, np.array([2, 0]), whole=False)
    assert (part.time, part.angles.tolist(), part.keyed) == (1.5, [0.3, 0.1], (False, True))
    assert (part.syncs, part.passages, part.is_exact) == ((("a", "stroke"),), (), False)
    assert clashes._part(whole, np.array([2, 0]), whole=True).keyed == (True, True)

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import key_times
from kinesic.motion.budget import ENDLESS
from kinesic.motion.condition import condition
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.plane_memory import PlaneMemory

LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
ROWS = (
    (0.0, 0.0, 0.0, "start"),
    (0.4, 0.6, 0.0, "ready"),
    (0.6, -0.6, 1.0, "stroke"),
    (0.8, 0.6, 1.0, "relax"),
    (1.6, 0.0, 1.0, "pause"),
    (2.2, 0.0, 0.0, "end"),
)


def keys_of(rows=ROWS, later: float = 0.0) -> tuple[KeyPosture, ...]:
    return tuple(KeyPosture(time + later, sealed(turn), (True, True), (("b", sync),)) for time, *turn, sync in rows)


@pytest.fixture
def measured(monkeypatch):
    found = []
    measure = key_times.measure_shortage
    monkeypatch.setattr(
        key_times,
        "measure_shortage",
        lambda segment, limits, **options: found.append(segment) or measure(segment, limits, **options),
    )
    return found


@pytest.fixture
def memory():
    memory = PlaneMemory()
    condition(keys_of(), LIMITS, memory=memory)
    return memory


@pytest.mark.parametrize("later", [0.0, 7.3])
def test_a_second_search_begins_where_the_first_one_ended(memory, measured, later):
    alone = condition(keys_of(later=later), LIMITS)
    looked = len(measured)
    again = condition(keys_of(later=later), LIMITS, memory=memory)
    np.testing.assert_allclose(again.planned, alone.planned, atol=0.002)
    assert looked > 4
    assert len(measured) - looked < looked / 3
    assert {pair: found.quantity for pair, found in again.bottlenecks.items()} == {
        pair: found.quantity for pair, found in alone.bottlenecks.items()
    }


def test_what_hinges_do_beside_what_is_known_changes_nothing(memory, measured):
    rows = (*ROWS[:-1], (2.2, 0.0, 0.4, "more"), (3.0, 0.0, 0.0, "end"))
    alone = condition(keys_of(rows), LIMITS)
    looked = len(measured)
    found = condition(keys_of(rows), LIMITS, memory=memory)
    np.testing.assert_allclose(found.planned, alone.planned, atol=0.002)
    assert len(measured) - looked < looked / 2


def test_planes_hold_under_tighter_limits_and_not_under_wider_ones(memory):
    keys = Keys.of(keys_of(), LIMITS)
    assert memory.recall(keys, LIMITS.times(0.9))[0]
    assert not memory.recall(keys, LIMITS.times(1.1))[0]
    assert not memory.recall(keys, replace(LIMITS, viscous=sealed([0.1, 0.1])))[0]


def test_planes_are_of_the_same_angles_and_sync_points(memory):
    known = memory.recall(Keys.of(keys_of(), LIMITS), LIMITS)[0]
    assert 0 in known
    others = tuple((time, 1.01 * first, second, sync) for time, first, second, sync in ROWS)
    assert 0 not in memory.recall(Keys.of(keys_of(others), LIMITS), LIMITS)[0]
    renamed = tuple((*row[:-1], f"other_{row[-1]}") for row in ROWS)
    assert not memory.recall(Keys.of(keys_of(renamed), LIMITS), LIMITS)[0]


def test_a_plane_stays_the_same_when_all_keys_move_together(memory):
    keys = Keys.of(keys_of(), LIMITS)
    for cuts in memory.recall(keys, LIMITS)[0].values():
        for cut in cuts:
            assert cut.slopes.sum() == pytest.approx(0.0, abs=1e-9)


def test_what_was_known_before_the_last_search_is_kept(memory):
    keys = Keys.of(keys_of(), LIMITS)
    others = keys_of(tuple((*row[:-1], f"other_{row[-1]}") for row in ROWS))
    condition(others, LIMITS, memory=memory, budget=ENDLESS)
    assert memory.recall(keys, LIMITS)[0]
    assert memory.recall(Keys.of(others, LIMITS), LIMITS)[0]


def test_what_a_search_of_one_hinge_found_is_known_to_that_of_all(measured):
    other, alone = PlaneMemory(), PlaneMemory()
    part = tuple(
        KeyPosture(key.time, sealed(key.angles[1:]), (True,), key.syncs)  # of the second hinge
        for key in keys_of()
    )
    condition(part, LIMITS.part(np.array([1])), memory=alone)
    other.learn(alone, [1], (True, True))
    cuts, met = other.recall(Keys.of(keys_of(), LIMITS), LIMITS)
    assert cuts.keys() == {1}
    assert {found.hinge for found in met.values()} == {1}
    assert not PlaneMemory().recall(Keys.of(keys_of(), LIMITS), LIMITS)[0]
    assert not other.part([0]).recall(Keys.of(part, LIMITS.part(np.array([1]))), LIMITS)[0]


@pytest.mark.parametrize("backwards", [False, True])
def test_what_is_about_a_rest_at_the_end_of_a_part_is_not_known_to_the_whole(backwards):
    """There the hinge of the whole may go on."""
    turned = tuple((ROWS[-1][0] - time, *turn, sync) for time, *turn, sync in reversed(ROWS))
    rows, memory = turned if backwards else ROWS, PlaneMemory()
    condition(keys_of(rows), LIMITS, memory=memory)
    keys, end = Keys.of(keys_of(rows), LIMITS), len(ROWS) - 1 if backwards else 0

    def about(*whole: bool) -> set[int]:
        learned = PlaneMemory()
        learned.learn(memory, [0, 1], whole)
        cuts = [cut for own in learned.recall(keys, LIMITS)[0].values() for cut in own]
        return {int(key) for cut in cuts for key in np.flatnonzero(cut.slopes)}

    assert end in about(True, True)
    assert end in about(not backwards, backwards)
    assert end not in about(backwards, not backwards)


def test_only_planes_that_hold_back_the_times_are_lent_to_other_searches(memory):
    keys = Keys.of(keys_of(), LIMITS)
    every = [cut for own in memory.recall(keys, LIMITS)[0].values() for cut in own]
    lent = [cut for own in memory.part([0, 1]).recall(keys, LIMITS)[0].values() for cut in own]
    times = condition(keys_of(), LIMITS).planned
    assert 0 < len(lent) < len(every)
    assert all(abs(float(cut.slopes @ times) - cut.bound) < 0.005 for cut in lent)

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import key_times
from kinesic.motion.budget import UNLIMITED_BUDGET
from kinesic.motion.condition import condition
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.plane_memory import PlaneMemory

# limits of two hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
HURRIED_ROWS = (  # key time [s], angles of both hinges [rad] and sync point
    (0.0, 0.0, 0.0, "start"),
    (0.4, 0.6, 0.0, "ready"),
    (0.6, -0.6, 1.0, "stroke"),
    (0.8, 0.6, 1.0, "relax"),
    (1.6, 0.0, 1.0, "pause"),
    (2.2, 0.0, 0.0, "end"),
)


def keys_of(rows=HURRIED_ROWS, later: float = 0.0) -> tuple[KeyPosture, ...]:
    return tuple(KeyPosture(time + later, sealed(turn), (True, True), (("b", sync),)) for time, *turn, sync in rows)


@pytest.fixture
def measured(monkeypatch):
    measured_segments = []
    measure = key_times.measure_time_deficit
    monkeypatch.setattr(
        key_times,
        "measure_time_deficit",
        lambda segment, limits, **options: measured_segments.append(segment) or measure(segment, limits, **options),
    )
    return measured_segments


@pytest.fixture
def memory():
    memory = PlaneMemory()
    condition(keys_of(), JOINT_LIMITS, memory=memory)
    return memory


@pytest.mark.parametrize("later", [0.0, 7.3])
def test_repeated_search_with_stored_cutting_planes_needs_under_a_third_of_the_measurements(memory, measured, later):
    alone = condition(keys_of(later=later), JOINT_LIMITS)
    count = len(measured)
    repeated = condition(keys_of(later=later), JOINT_LIMITS, memory=memory)
    np.testing.assert_allclose(repeated.planned, alone.planned, atol=0.002)
    assert count > 4
    assert len(measured) - count < count / 3
    assert {pair: found.quantity for pair, found in repeated.bottlenecks.items()} == {
        pair: found.quantity for pair, found in alone.bottlenecks.items()
    }


def test_cutting_planes_are_reused_if_only_another_hinge_has_new_keys(memory, measured):
    rows = (*HURRIED_ROWS[:-1], (2.2, 0.0, 0.4, "more"), (3.0, 0.0, 0.0, "end"))
    alone = condition(keys_of(rows), JOINT_LIMITS)
    count = len(measured)
    conditioned = condition(keys_of(rows), JOINT_LIMITS, memory=memory)
    np.testing.assert_allclose(conditioned.planned, alone.planned, atol=0.002)
    assert len(measured) - count < count / 2


def test_stored_cutting_planes_are_valid_for_tighter_limits_only(memory):
    keys = Keys.of(keys_of(), JOINT_LIMITS)
    assert memory.recall(keys, JOINT_LIMITS.scaled(0.9))[0]
    assert not memory.recall(keys, JOINT_LIMITS.scaled(1.1))[0]
    assert not memory.recall(keys, replace(JOINT_LIMITS, viscous=sealed([0.1, 0.1])))[0]


def test_stored_cutting_planes_require_equal_angles_and_sync_points(memory):
    known = memory.recall(Keys.of(keys_of(), JOINT_LIMITS), JOINT_LIMITS)[0]
    assert 0 in known
    others = tuple((time, 1.01 * first, second, sync) for time, first, second, sync in HURRIED_ROWS)
    assert 0 not in memory.recall(Keys.of(keys_of(others), JOINT_LIMITS), JOINT_LIMITS)[0]
    renamed = tuple((*row[:-1], f"other_{row[-1]}") for row in HURRIED_ROWS)
    assert not memory.recall(Keys.of(keys_of(renamed), JOINT_LIMITS), JOINT_LIMITS)[0]


def test_stored_cutting_plane_is_invariant_to_a_common_time_shift(memory):
    keys = Keys.of(keys_of(), JOINT_LIMITS)
    for planes in memory.recall(keys, JOINT_LIMITS)[0].values():
        for plane in planes:
            assert plane.slopes.sum() == pytest.approx(0.0, abs=1e-9)


def test_cutting_planes_of_an_earlier_search_are_kept_after_another_search(memory):
    keys = Keys.of(keys_of(), JOINT_LIMITS)
    others = keys_of(tuple((*row[:-1], f"other_{row[-1]}") for row in HURRIED_ROWS))
    condition(others, JOINT_LIMITS, memory=memory, budget=UNLIMITED_BUDGET)
    assert memory.recall(keys, JOINT_LIMITS)[0]
    assert memory.recall(Keys.of(others, JOINT_LIMITS), JOINT_LIMITS)[0]


def test_cutting_planes_of_a_single_hinge_search_apply_to_the_search_of_all_hinges(measured):
    other, alone = PlaneMemory(), PlaneMemory()
    part = tuple(
        KeyPosture(key.time, sealed(key.angles[1:]), (True,), key.syncs)  # of the second hinge
        for key in keys_of()
    )
    condition(part, JOINT_LIMITS.part(np.array([1])), memory=alone)
    other.learn(alone, [1], (True, True))
    planes, bottlenecks = other.recall(Keys.of(keys_of(), JOINT_LIMITS), JOINT_LIMITS)
    assert planes.keys() == {1}
    assert {bottleneck.hinge for bottleneck in bottlenecks.values()} == {1}
    assert not PlaneMemory().recall(Keys.of(keys_of(), JOINT_LIMITS), JOINT_LIMITS)[0]
    assert not other.part([0]).recall(Keys.of(part, JOINT_LIMITS.part(np.array([1]))), JOINT_LIMITS)[0]


@pytest.mark.parametrize("backwards", [False, True])
def test_cutting_planes_at_open_ends_of_a_partial_search_are_not_reused(backwards):
    """Test a partial search whose hinge may move beyond one end."""
    turned = tuple((HURRIED_ROWS[-1][0] - time, *turn, sync) for time, *turn, sync in reversed(HURRIED_ROWS))
    rows, memory = turned if backwards else HURRIED_ROWS, PlaneMemory()
    condition(keys_of(rows), JOINT_LIMITS, memory=memory)
    keys, end = Keys.of(keys_of(rows), JOINT_LIMITS), len(HURRIED_ROWS) - 1 if backwards else 0

    def about(*whole: bool) -> set[int]:
        learned = PlaneMemory()
        learned.learn(memory, [0, 1], whole)
        learned_planes = [plane for planes in learned.recall(keys, JOINT_LIMITS)[0].values() for plane in planes]
        return {int(key) for plane in learned_planes for key in np.flatnonzero(plane.slopes)}

    assert end in about(True, True)
    assert end in about(not backwards, backwards)
    assert end not in about(backwards, not backwards)


def test_only_active_cutting_planes_are_copied_to_other_searches(memory):
    keys = Keys.of(keys_of(), JOINT_LIMITS)
    all_planes = [plane for planes in memory.recall(keys, JOINT_LIMITS)[0].values() for plane in planes]
    copied = [plane for planes in memory.part([0, 1]).recall(keys, JOINT_LIMITS)[0].values() for plane in planes]
    times = condition(keys_of(), JOINT_LIMITS).planned
    assert 0 < len(copied) < len(all_planes)
    assert all(abs(float(plane.slopes @ times) - plane.bound) < 0.005 for plane in copied)

"""Tests of storage, reduction and recall of cutting planes."""

from dataclasses import fields, replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.key_time_lp import CuttingPlane
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.plane_memory import MAX_STORED_PLANES, PlaneMemory, _make_portable

# limits of two hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
SYNC_NAMES = ("start", "ready", "stroke", "relax", "pause", "end")  # sync points of the keys


def keys_of(names=SYNC_NAMES, skipped: int | None = None) -> Keys:
    """Return keys 1 s apart, optionally one without the second hinge."""
    return Keys.of(
        tuple(
            KeyPosture(float(k), sealed([0.1 * len(name), 0.2]), (True, k != skipped), (("b", name),))
            for k, name in enumerate(names)
        ),
        JOINT_LIMITS,
    )


SPACED_KEYS = keys_of()  # keys a second apart
# bottleneck of the first hinge, which needs 1.2 times the available time
VELOCITY_BOTTLENECK = Bottleneck(0, "speed", 1.2)


def plane(*slopes: float, bound: float = 0.5) -> CuttingPlane:
    return CuttingPlane(sealed(slopes), bound)


def memory_of(*planes: CuttingPlane, hinge: int = 0, keys: Keys = SPACED_KEYS, bottlenecks=None) -> PlaneMemory:
    memory = PlaneMemory()
    memory.store(keys, JOINT_LIMITS, {hinge: planes}, bottlenecks or {}, keys.requested_times)
    return memory


def recalled(
    memory: PlaneMemory, keys: Keys = SPACED_KEYS, limits: Limits = JOINT_LIMITS
) -> dict[int, list[list[float]]]:
    return {hinge: [own.slopes.tolist() for own in planes] for hinge, planes in memory.recall(keys, limits)[0].items()}


def test_stored_cutting_plane_keeps_only_its_keys_and_one_neighbour_on_each_side():
    stored = _make_portable(plane(0, 0, 2, -2, 0, 0), 0, SPACED_KEYS, JOINT_LIMITS, {})
    assert [mark[0][0][1] for mark in stored.marks] == ["ready", "stroke", "relax", "pause"]
    assert stored.slopes.tolist() == [0, 2, -2, 0]
    assert (stored.hinge, stored.bound, stored.reaches, stored.slack) == (0, 0.5, (False, False), 0.0)
    assert stored.limits.lower.tolist() == [-2.0]


@pytest.mark.parametrize(
    ("slopes", "kept", "reaches"),
    [
        ((2, -2, 0, 0, 0, 0), [2, -2, 0], (True, False)),
        ((0, 0, 0, 0, 2, -2), [0, 2, -2], (False, True)),
        ((1, 0, 0, 0, 0, -1), [1, 0, 0, 0, 0, -1], (True, True)),
        ((0, 3, 0, -3, 0, 0), [0, 3, 0, -3, 0], (False, False)),
        ((0, 0, 5, 0, 0, 0), [0, 5, 0], (False, False)),
    ],
)
def test_stored_cutting_plane_reaches_a_motion_end_if_it_involves_the_key_there(slopes, kept, reaches):
    stored = _make_portable(plane(*slopes), 0, SPACED_KEYS, JOINT_LIMITS, {})
    assert (stored.slopes.tolist(), stored.reaches) == (kept, reaches)


def test_negligible_slopes_of_a_stored_cutting_plane_are_added_to_the_nearest_involved_key():
    slopes = np.array([0.9e-4, 0.5e-4, 1.0, -1.0 - 0.5e-4, -0.4e-4, -0.5e-4])
    stored = _make_portable(plane(*slopes), 0, SPACED_KEYS, JOINT_LIMITS, {})
    np.testing.assert_allclose(stored.slopes, [0.0, 1.0 + 1.4e-4, -1.0 - 1.4e-4, 0.0])
    steeper = _make_portable(plane(1.2e-4, 0, 1.0, -1.0 - 1.2e-4, 0, 0), 0, SPACED_KEYS, JOINT_LIMITS, {})
    assert len(steeper.marks) == 5


def test_stored_cutting_plane_keeps_only_bottlenecks_of_its_hinge_and_keys():
    found = {
        (2, 3): VELOCITY_BOTTLENECK,
        (1, 2): replace(VELOCITY_BOTTLENECK, ratio=1.3),
        (0, 1): VELOCITY_BOTTLENECK,
        (3, 5): VELOCITY_BOTTLENECK,
        (3, 4): replace(VELOCITY_BOTTLENECK, hinge=1),
    }
    stored = _make_portable(plane(0, 0, 2, -2, 0, 0), 0, SPACED_KEYS, JOINT_LIMITS, found)
    assert dict(stored.bottlenecks) == {(1, 2): VELOCITY_BOTTLENECK, (0, 1): replace(VELOCITY_BOTTLENECK, ratio=1.3)}


def test_cutting_plane_of_a_hinge_without_a_key_at_some_time_has_slope_zero_there():
    keys = keys_of(skipped=2)
    memory = memory_of(plane(0, 2, 0, -2, 0, 0), hinge=1, keys=keys)
    assert recalled(memory, keys) == {1: [[0, 2, 0, -2, 0, 0]]}
    longer = keys_of(("begin", *SYNC_NAMES), skipped=3)
    assert recalled(memory, longer) == {1: [[0, 0, 2, 0, -2, 0, 0]]}


def test_stored_cutting_plane_is_recalled_if_all_its_keys_are_adjacent():
    memory = memory_of(plane(0, 0, 2, -2, 0, 0))
    assert recalled(memory) == {0: [[0, 0, 2, -2, 0, 0]]}
    assert recalled(memory, keys_of(SYNC_NAMES[1:5])) == {0: [[0, 2, -2, 0]]}
    assert recalled(memory, keys_of(("x", "y", *SYNC_NAMES[1:5]))) == {0: [[0, 0, 0, 2, -2, 0]]}
    assert recalled(memory, keys_of(SYNC_NAMES[2:])) == {}
    assert recalled(memory, keys_of(("start", "ready", "stroke", "other", "relax", "pause", "end"))) == {}
    assert memory.recall(SPACED_KEYS, JOINT_LIMITS)[0][0][0].bound == 0.5


@pytest.mark.parametrize("name", [item.name for item in fields(Limits)])
def test_stored_cutting_plane_is_recalled_for_equal_or_tighter_limits_of_its_hinge(name):
    memory = memory_of(plane(0, 0, 2, -2, 0, 0))
    own = getattr(JOINT_LIMITS, name)
    assert recalled(memory)
    assert not recalled(memory, limits=replace(JOINT_LIMITS, **{name: sealed(own + 0.01)}))
    is_monotone = name in ("speed", "acceleration", "jerk", "duty")
    assert bool(recalled(memory, limits=replace(JOINT_LIMITS, **{name: sealed(own - 0.001)}))) is is_monotone
    other_hinge = sealed([own[0], own[1] + 5.0])
    assert recalled(memory, limits=replace(JOINT_LIMITS, **{name: other_hinge})), (
        "of the other hinge they do not matter"
    )


@pytest.mark.parametrize(("bound", "is_reported"), [(-2.0, False), (-2.0 - 1e-9, True), (-1.5, False), (-3.0, True)])
def test_bottlenecks_are_recalled_if_the_requested_times_violate_their_cutting_plane(bound, is_reported):
    memory = memory_of(
        plane(0, 0, 2, -2, 0, 0, bound=bound), bottlenecks={(2, 3): VELOCITY_BOTTLENECK, (1, 2): VELOCITY_BOTTLENECK}
    )
    later = keys_of(("begin", *SYNC_NAMES))
    assert memory.recall(later, JOINT_LIMITS)[1] == (
        {(3, 4): VELOCITY_BOTTLENECK, (2, 3): VELOCITY_BOTTLENECK} if is_reported else {}
    )


def test_search_of_some_hinges_gets_their_active_cutting_planes_with_renumbered_hinges():
    tight, near, far = (plane(0, 0, 2, -2, 0, 0, bound=-2.0 + slack) for slack in (0.0, 0.0019, 0.0021))
    memory = PlaneMemory()
    memory.store(
        SPACED_KEYS,
        JOINT_LIMITS,
        {0: [far], 1: [tight, near, far]},
        {(2, 3): replace(VELOCITY_BOTTLENECK, hinge=1)},
        SPACED_KEYS.requested_times,
    )
    one = Keys.of(
        [replace(key, angles=key.angles[1:], keyed=(True,)) for key in postures()], JOINT_LIMITS.part(np.array([1]))
    )
    planes, bottlenecks = memory.part([1]).recall(one, JOINT_LIMITS.part(np.array([1])))
    assert [own.bound for own in planes[0]] == [tight.bound, near.bound]
    assert bottlenecks == {}
    assert memory.part([0]).recall(SPACED_KEYS, JOINT_LIMITS)[0] == {}
    swapped = memory.part([1, 0])._planes
    assert {own.hinge for own in swapped} == {0}
    assert {item.hinge for own in swapped for _, item in own.bottlenecks} == {0}


def postures() -> list[KeyPosture]:
    return [
        KeyPosture(float(k), sealed([0.1 * len(name), 0.2]), (True, True), (("b", name),))
        for k, name in enumerate(SYNC_NAMES)
    ]


@pytest.mark.parametrize("has_start", [True, False])
@pytest.mark.parametrize("has_end", [True, False])
def test_cutting_planes_at_an_open_end_of_a_partial_search_are_not_learned(has_start, has_end):
    begin, middle, end = plane(2, -2, 0, 0, 0, 0), plane(0, 0, 2, -2, 0, 0), plane(0, 0, 0, 0, 2, -2)
    learned = PlaneMemory()
    learned.learn(memory_of(begin, middle, end), [1], (has_start, has_end))
    expected = [begin] * has_start + [middle] + [end] * has_end
    swapped = Keys.of([replace(key, angles=key.angles[::-1]) for key in postures()], JOINT_LIMITS)
    assert recalled(learned, swapped) == {1: [own.slopes.tolist() for own in expected]}


def test_learned_cutting_planes_replace_only_those_of_their_hinges():
    memory = PlaneMemory()
    old = plane(0, 2, -2, 0, 0, 0)
    memory.store(SPACED_KEYS, JOINT_LIMITS, {0: [old], 1: [old]}, {}, SPACED_KEYS.requested_times)
    memory.learn(memory_of(plane(0, 0, 2, -2, 0, 0)), [0], (True, True))
    assert recalled(memory) == {0: [[0, 0, 2, -2, 0, 0]], 1: [[0, 2, -2, 0, 0, 0]]}
    assert [own.hinge for own in memory._planes] == [0, 1], "the new ones come first"


def test_recalled_cutting_planes_are_stored_once_with_their_new_slack():
    memory = memory_of(plane(0, 0, 2, -2, 0, 0, bound=-1.0), plane(0, 2, -2, 0, 0, 0, bound=-1.0))
    planes, _ = memory.recall(SPACED_KEYS, JOINT_LIMITS)
    times = SPACED_KEYS.requested_times.copy()
    times[3:] -= 0.25
    fresh = plane(0, 0, 0, 2, -2, 0)
    memory.store(SPACED_KEYS, JOINT_LIMITS, {0: [planes[0][0], fresh]}, {}, times)
    assert [own.slack for own in memory._planes] == pytest.approx([0.5, 2.5])
    assert recalled(memory) == {0: [[0, 0, 2, -2, 0, 0], [0, 0, 0, 2, -2, 0]]}


def test_cutting_planes_that_were_not_recalled_are_kept_behind_new_ones():
    memory = memory_of(plane(0, 0, 2, -2, 0, 0))
    others = keys_of(tuple(f"other_{name}" for name in SYNC_NAMES))
    memory.recall(others, JOINT_LIMITS)
    memory.store(others, JOINT_LIMITS, {0: [plane(0, 3, -3, 0, 0, 0)]}, {}, others.requested_times)
    assert recalled(memory) == {0: [[0, 0, 2, -2, 0, 0]]}
    assert recalled(memory, others) == {0: [[0, 3, -3, 0, 0, 0]]}
    assert [own.slopes.max() for own in memory._planes] == [3.0, 2.0]


def test_plane_memory_keeps_the_newest_200_cutting_planes():
    memory = memory_of(*(plane(0, 0, 2, -2, 0, 0, bound=float(k)) for k in range(150)))
    others = keys_of(tuple(f"other_{name}" for name in SYNC_NAMES))
    fresh = [plane(0, 0, 2, -2, 0, 0, bound=float(k)) for k in range(100)]
    memory.recall(others, JOINT_LIMITS)
    memory.store(others, JOINT_LIMITS, {0: fresh}, {}, others.requested_times)
    assert (MAX_STORED_PLANES, len(memory._planes)) == (200, 200)
    assert len(recalled(memory, others)[0]) == 100
    whole = PlaneMemory()
    whole.store(SPACED_KEYS, JOINT_LIMITS, {1: [plane(0, 0, 2, -2, 0, 0)]}, {}, SPACED_KEYS.requested_times)
    whole.learn(memory, [0], (True, True))
    assert (len(whole._planes), {own.hinge for own in whole._planes}) == (200, {0})

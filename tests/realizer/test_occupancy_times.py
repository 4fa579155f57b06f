"""Times, roles and held postures of occupancies, on hand-made plans."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.expressivity.keyframes import HeldTurns, Turn
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.syncs import SyncTime
from kinesic.realizer import occupancy as module
from kinesic.realizer.occupancy import (
    MergeFailure,
    Occupancy,
    Overlay,
    arm_hinges,
    freed_hinges,
    held_angles,
    occupancy_of,
    remaining_occupancy,
    settle_occupancy,
    sort_by_time,
)

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
GAZE = '<gaze id="z" target="left"/>'
LOOK = '<gazeShift id="{}" target="left"/>'
LEAN = '<postureShift id="p"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></postureShift>'
HINGE_COUNT = 22
NECK = 3  # index of a neck hinge whose rest angle is 0
ROW_COUNT = 60  # control points of the test motions
BLOCK_ZERO = 0.2  # [s] time of block time 0 in the test plans


@pytest.fixture
def planned(known):
    """Return a plan of given behaviours, with block times [s] by behaviour and sync point."""

    def of(text: str, times: dict, *, uses: dict, controls=None, held=None):
        rows = np.zeros((ROW_COUNT, HINGE_COUNT)) if controls is None else controls
        return SimpleNamespace(
            setup=known,
            trajectory=Trajectory(rows, BLOCK_ZERO),
            timeline=SimpleNamespace(block=parse(ROOT.format(text))),
            keyframes=SimpleNamespace(uses={id: frozenset(parts) for id, parts in uses.items()}, held=held or {}),
            syncs=[SyncTime(id, sync, 0.0, time) for id, at in times.items() for sync, time in at.items()],
        )

    return of


def use(id: str = "a", *roles: str, begin=0.0, ready=0.5, relax=1.0, end=1.5, offset=None, hinges=()) -> Occupancy:
    moved = np.isin(np.arange(HINGE_COUNT), hinges)
    return Occupancy(id, frozenset(roles), moved, begin, ready, relax, end, offset)


def test_occupancies_are_sorted_by_begin_and_name_and_only_include_moving_behaviours(planned):
    nods = "".join(f'<head id="{id}" lexeme="NOD"/>' for id in "abcd")
    times = {"d": {"start": 0.1}, "c": {"start": 0.3}, "b": {"start": 0.1}, "a": {"start": 0.0}}
    plan = planned(nods, times, uses={"d": ["head"], "c": ["head"], "b": ["head"], "a": []})
    entries = occupancy_of(plan)
    assert [(entry.behaviour, entry.begin) for entry in entries] == [
        ("b", pytest.approx(0.3)),
        ("d", pytest.approx(0.3)),
        ("c", pytest.approx(0.5)),
    ]


@pytest.mark.parametrize(
    ("text", "times", "expected"),
    [
        (GAZE, {"ready": 0.5, "relax": 1.0, "start": 0.1, "end": 2.0}, (0.1, 0.5, 1.0, 2.0)),
        (GAZE, {"ready": 1.5, "relax": 1.0, "start": 0.1, "end": 2.0}, (0.1, 1.0, 1.0, 2.0)),
        (GAZE, {"start": 0.1, "end": 2.0}, (0.1, 2.0, 2.0, 2.0)),
        (GAZE, {"start": 0.1, "later": 2.0}, (0.1, 2.0, 2.0, 2.0)),
        (GAZE, {"relax": 1.0, "start": 0.1, "end": 2.0}, (0.1, 1.0, 1.0, 2.0)),
        (GAZE, {"strokeStart": 0.4, "strokeEnd": 0.9, "stroke": 0.6, "end": 2.0}, (0.4, 0.4, 0.9, 2.0)),
        (LOOK.format("z"), {"ready": 0.5, "relax": 1.0, "start": 0.1, "end": 2.0}, (0.1, 0.5, 2.0, 2.0)),
    ],
)
def test_times_of_an_occupancy_come_from_the_sync_points(planned, text, times, expected):
    held = {"z": HeldTurns("look")}
    (entry,) = occupancy_of(planned(text, {"z": times}, uses={"z": ["head"]}, held=held))
    result = (entry.begin, entry.ready, entry.relax, entry.end)
    assert result == pytest.approx(tuple(time + BLOCK_ZERO for time in expected))
    assert entry.is_held is (text != GAZE)


def test_occupied_hinges_are_those_of_the_used_parts_that_move(planned, known):
    neck, torso = known.robot.joints("neck"), known.robot.joints("torso")
    controls = np.zeros((ROW_COUNT, HINGE_COUNT))
    controls[9, neck[0]] = 1.1e-9
    controls[9, neck[1]] = 1.0e-9
    controls[9, torso[0]] = 1.0
    (entry,) = occupancy_of(planned(GAZE, {"z": {"start": 0.0}}, uses={"z": ["head"]}, controls=controls))
    assert np.flatnonzero(entry.hinges).tolist() == [neck[0]]


def turning(known, *, rows: dict[int, float], row_count: int = ROW_COUNT) -> np.ndarray:
    """Return control points whose left shoulder has other angles [rad] from some rows on."""
    controls = np.tile(known.robot.skeleton.rest, (row_count, 1))
    for row, angle in rows.items():
        controls[row:, arm_hinges("l_hand", known.robot)[0]] = angle
    return controls


@pytest.mark.parametrize(("end", "expected"), [(0.3, 0.1), (0.304, 0.1), (0.306, 0.2), (0.31, 0.2), (ROW_COUNT, 0.5)])
def test_held_arm_angle_is_the_planned_angle_at_the_end_of_the_posture_shift(planned, known, end, expected):
    """The control point after a knot shapes the angle at the knot most."""
    arm = arm_hinges("l_hand", known.robot)[0]
    controls = turning(known, rows={1: 0.05, 31: 0.1, 32: 0.2, ROW_COUNT - 2: 0.5, ROW_COUNT - 1: 0.7})
    plan = planned(
        LEAN,
        {"p": {"end": end - BLOCK_ZERO}},
        uses={"p": ["l_hand"]},
        controls=controls,
        held={"p": HeldTurns("posture")},
    )
    (entry,) = occupancy_of(plan)
    assert entry.roles == {"l_hand"}
    assert entry.offset[arm] == pytest.approx(expected)
    assert not np.delete(entry.offset, arm).any()
    assert np.flatnonzero(entry.hinges).tolist() == [arm]


def look(turn: float) -> HeldTurns:
    return HeldTurns("look", head=Turn(torsion=turn))


@pytest.mark.parametrize(
    ("held", "ends", "expected"),
    [
        ({"y": look(0.1), "z": look(0.2)}, 0.25, {"y": 0.1, "z": 0.25}),
        ({"z": look(0.2), "y": look(0.1)}, 0.25, {"y": 0.25, "z": 0.2}),
        ({"y": look(0.1), "p": HeldTurns("posture")}, 0.25, {"y": 0.1, "p": 0.15}),
        ({"y": look(0.1), "z": look(0.2), "p": HeldTurns("posture")}, 0.25, {"y": 0.1, "z": 0.2, "p": 0.05}),
        ({"p": HeldTurns("posture")}, 0.25, {"p": 0.25}),
    ],
)
def test_last_posture_shift_or_else_last_gaze_shift_holds_the_remainder_of_the_end_angle(
    planned, known, held, ends, expected
):
    neck = known.robot.joints("neck")[0]
    controls = np.tile(known.robot.skeleton.rest, (ROW_COUNT, 1))
    controls[:, neck] = 0.03
    controls[1:, neck] = 0.1
    controls[-1, neck] = 0.03 + ends
    text = "".join(LEAN if id == "p" else LOOK.format(id) for id in sorted(held))
    uses = {id: ["torso"] for id in held}
    plan = planned(text, {id: {"end": 0.1} for id in held}, uses=uses, controls=controls, held=held)
    offsets = {entry.behaviour: entry.offset[neck] for entry in occupancy_of(plan)}
    assert offsets == pytest.approx(expected)


def test_held_posture_occupies_trunk_hinges_that_the_plan_does_not_move(planned, known):
    neck, arm = known.robot.joints("neck")[0], arm_hinges("l_hand", known.robot)[0]
    controls = turning(known, rows={10: 1.0e-9})
    held = {"y": look(0.1), "z": look(0.0)}
    times = {id: {"end": 0.1} for id in held}
    text = LOOK.format("y") + LOOK.format("z")
    entries = occupancy_of(
        planned(text, times, uses={"y": ["head", "l_hand"], "z": ["head"]}, controls=controls, held=held)
    )
    assert [np.flatnonzero(entry.hinges).tolist() for entry in entries] == [[neck], []]
    assert arm not in np.flatnonzero(entries[0].hinges)


def test_held_rotations_add_to_those_of_the_rest_posture(known, monkeypatch):
    torso, neck = known.robot.joints("torso")[0], known.robot.joints("neck")[0]
    monkeypatch.setattr(module, "rest_turn", lambda *_: Turn(torsion=0.05))
    monkeypatch.setattr(module, "rest_head_turn", lambda *_: Turn(torsion=0.07))
    angles = held_angles(HeldTurns("look", head=Turn(torsion=0.5), torso=Turn(torsion=0.2)), known.robot)
    assert (angles[torso], angles[neck]) == pytest.approx((0.25, 0.32))


def test_held_gaze_subtracts_the_torso_angle_from_the_neck_angle(known):
    torso, neck = known.robot.joints("torso")[0], known.robot.joints("neck")[0]
    angles = held_angles(HeldTurns("look", head=Turn(torsion=0.5), torso=Turn(torsion=0.2)), known.robot)
    assert (angles[torso], angles[neck]) == pytest.approx((0.2, 0.3))
    trunk = [*known.robot.joints("torso"), *known.robot.joints("neck")]
    assert not np.delete(angles, trunk).any()


@pytest.mark.parametrize(
    ("ready", "relax", "conflicts"), [(1.0, 2.0, False), (0.99, 2.0, True), (0.1, 0.5, False), (0.1, 0.51, True)]
)
def test_occupancies_conflict_only_if_their_busy_times_overlap(ready, relax, conflicts):
    first, second = use("a", "sign"), use("b", "sign", ready=ready, relax=relax)
    assert first.conflicts_with(second) is conflicts
    assert second.conflicts_with(first) is conflicts


def test_behaviour_holds_a_gaze_or_posture_only_if_it_has_this_role_and_a_held_offset():
    assert use("a", "look", offset=np.zeros(HINGE_COUNT)).holds("look")
    assert not use("a", "look", offset=np.zeros(HINGE_COUNT)).holds("trunk")
    assert not use("a", "look").holds("look")


def test_shifted_occupancy_moves_all_its_times():
    entry = use().shifted(2.0)
    assert (entry.begin, entry.ready, entry.relax, entry.end) == (2.0, 2.5, 3.0, 3.5)


def test_occupancy_times_within_a_microsecond_are_sorted_as_equal():
    for entries in ([(1.0, 5.0), (2.0, 1.0)], [(1.0 - 0.9e-6, 4.0), (1.0, 5.0)], [(1.0 - 1.1e-6, 5.0), (1.0, 4.0)]):
        assert sort_by_time(entries, lambda entry: entry) == entries
        assert sort_by_time(entries[::-1], lambda entry: entry) == entries
    same = [("b", (1.0,)), ("a", (1.0 - 0.9e-6,))]
    assert sort_by_time(same, lambda entry: entry[1]) == same


@pytest.mark.parametrize(("relax", "remains"), [(1.0, False), (1.01, True)])
def test_occupancy_without_a_held_posture_remains_until_it_relaxes(relax, remains):
    entry = use(relax=relax)
    assert remaining_occupancy([entry], 1.0) == (entry,) * remains


@pytest.mark.parametrize(("relax", "is_replaced"), [(1.0, True), (1.01, False)])
def test_held_posture_remains_until_a_later_one_of_its_role_is_reached(relax, is_replaced):
    """A posture that is not reached yet does not end the held one."""
    first = use("a", "look", end=0.5, relax=0.5, offset=np.zeros(HINGE_COUNT))
    second = use("b", "look", end=relax, relax=relax, offset=np.zeros(HINGE_COUNT))
    lean = use("c", "trunk", end=0.1, relax=0.1, offset=np.zeros(HINGE_COUNT))
    expected = ["b", "c"] if is_replaced else ["a", "b", "c"]
    assert [entry.behaviour for entry in remaining_occupancy([first, second, lean], 1.0)] == expected


def test_only_the_last_held_posture_of_each_role_is_kept():
    offset = np.zeros(HINGE_COUNT)
    both = use("a", "look", "trunk", end=1.0, offset=offset)
    later, earlier = use("b", "look", end=2.0, offset=offset), use("c", "look", end=0.5, offset=offset)
    assert settle_occupancy([later, both, earlier, use("d", "trunk", end=9.0)]) in ((both, later), (later, both))
    assert settle_occupancy([both]) == (both,)


@pytest.mark.parametrize(("relax", "is_freed"), [(1.0, False), (1.01, True)])
def test_interrupted_block_releases_an_arm_only_if_a_behaviour_has_not_relaxed(known, relax, is_freed):
    moved = np.ones(HINGE_COUNT, dtype=np.bool_)
    block = [use("g", "r_hand", relax=0.5), use("h", "r_hand", relax=relax)]
    free = freed_hinges(block, moved, 1.0, known.robot)
    right = list(arm_hinges("r_hand", known.robot))
    assert free[right].all() == free[right].any() == is_freed
    assert np.delete(free, right).all()
    assert moved.all()


@pytest.mark.parametrize(
    ("role", "end", "offset", "is_freed"),
    [
        ("look", 1.6, np.zeros(HINGE_COUNT), False),
        ("look", 1.5, np.zeros(HINGE_COUNT), True),
        ("look", 1.6, None, True),
        ("trunk", 1.6, np.zeros(HINGE_COUNT), True),
    ],
)
def test_held_gaze_superseded_by_a_later_one_is_not_released(known, role, end, offset, is_freed):
    moved = np.ones(HINGE_COUNT, dtype=np.bool_)
    own = use("a", "look", offset=np.zeros(HINGE_COUNT), hinges=[NECK])
    free = freed_hinges(
        [own], moved, 1.0, known.robot, others=[use("past", "look"), use("b", role, end=end, offset=offset)]
    )
    assert free[NECK] == is_freed
    assert np.delete(free, NECK).all()
    passing = use("n", "look", hinges=[NECK])
    later = use("b", "look", end=9.0, offset=np.zeros(HINGE_COUNT))
    assert freed_hinges([passing], moved, 1.0, known.robot, others=[later]).all()


@pytest.mark.parametrize(
    ("performed", "named"),
    [
        ([], ""),
        ([use("g", "l_hand", "r_hand")], "g"),
        ([use("n", "sign"), use("g", "r_hand")], "n"),
        ([use("n", "sign"), use("g", "l_hand", "r_hand")], "n"),
        ([use("n", "sign"), use("z", "look", "r_hand"), use("g", "r_hand")], "z"),
    ],
)
def test_failure_of_the_trunk_names_the_last_behaviour_that_moves_it(performed, named):
    rows = np.zeros((9, HINGE_COUNT))
    failure = Overlay(rows, rows, rows[0], 0, (), performed).trunk_failure("cannot do both")
    assert failure == MergeFailure(named, "cannot do both")


def test_hinges_of_an_arm_are_those_of_its_side(known):
    assert arm_hinges("l_hand", known.robot) == known.robot.arm("l").all_joints
    assert arm_hinges("r_hand", known.robot) == known.robot.arm("r").all_joints

"""Rest angles, gaps and exclusions of hand-made robots, without their geometry."""

from math import cos, radians, sin
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest

from kinesic.body.robot_schema import CollisionTable, ExclusionTable
from kinesic.sim.importer import rest_pose as resting
from kinesic.sim.importer.rest_pose import (
    _make_hanging_target,
    _measure_arm_gap,
    _rest_arms,
    _round_into_range,
    find_limits_nearest_to_zero,
    rest_pose,
    with_exclusions,
)


class File(msgspec.Struct):
    """Part of the tables of a robot."""

    collision: CollisionTable
    rest: dict[str, float] = {}


def hinge(name="h", lower=-1.0, upper=1.0, *, joint=0, sign=1.0, zero=0.0):
    return SimpleNamespace(name=name, lower=lower, upper=upper, joint=joint, sign=sign, zero=zero)


def test_hinge_whose_range_excludes_zero_rests_at_its_limit_nearest_to_zero():
    hinges = (
        hinge("above", 0.1, 1.0),
        hinge("below", -1.0, -0.2),
        hinge("around"),
        hinge("from zero", 0.0, 1.0),
        hinge("to zero", -1.0, 0.0),
    )
    expected = {"above": 5.73, "below": -11.459}
    assert find_limits_nearest_to_zero(hinges) == expected


@pytest.mark.parametrize(
    ("angle", "degrees"), [(0.5, 28.65), (0.12345, 7.07), (1.0, 57.296), (2.0, 57.296), (-2.0, -57.296), (-0.5, -28.65)]
)
def test_rest_angle_is_rounded_without_leaving_the_rounded_joint_range(angle, degrees):
    assert _round_into_range(hinge(), angle) == degrees


@pytest.mark.parametrize("tilt", [0.3, -0.3])
def test_resting_arm_hangs_away_from_the_body_with_its_elbow_bent_by_18_degrees(tilt):
    bend = radians(18)
    target = _make_hanging_target(tilt)
    np.testing.assert_allclose(target.upper, (0, sin(tilt), -cos(tilt)))
    np.testing.assert_allclose(target.fore, (sin(bend), sin(tilt) * cos(bend), -cos(bend) * cos(tilt)))
    np.testing.assert_allclose(target.hinge, (0, -cos(tilt), -sin(tilt)), atol=1e-12)


def test_arms_are_posed_left_first_and_the_right_starts_from_its_mirror_image(monkeypatch):
    calls, mirrored = [], []

    def hang(tree, row, split, target, *, strict, first):
        calls.append((row, split, target.upper[1], strict, first.tolist()))
        return SimpleNamespace(angles=np.array([0.5, 4.0]) if row == (0, 1) else np.array([0.25, -0.5]))

    def mirror(tree, left, row, angles):
        mirrored.append((left, row, angles.tolist()))
        return -angles

    monkeypatch.setattr(resting, "hang_arm", hang)
    monkeypatch.setattr(resting, "mirror_angles", mirror)
    zeros = (0.1, 0.0, 0.0, 0.2, 0.0)
    figure = SimpleNamespace(
        tree=SimpleNamespace(joints=[SimpleNamespace(zero=zero) for zero in zeros]),
        arms={"l": SimpleNamespace(joints=(0, 1)), "r": SimpleNamespace(joints=(2, 3))},
        split="split",
    )
    hinges = (
        hinge("a", joint=0, zero=0.2),
        hinge("b", -3.0, 3.0, joint=1),
        hinge("c", joint=2, sign=-1.0),
        hinge("d", joint=3, zero=0.1, sign=-1.0),
        hinge("other", joint=4),
    )
    rest = _rest_arms(figure, hinges, 0.3)
    assert calls == [
        ((0, 1), "split", pytest.approx(sin(0.3)), True, [0.0, 0.0]),
        ((2, 3), "split", pytest.approx(-sin(0.3)), True, [-0.5, -4.0]),
    ]
    assert mirrored == [((0, 1), (2, 3), [0.5, 4.0])]
    angles = {"a": 0.4, "b": 4.0 - 2 * np.pi, "c": -0.25, "d": 0.4}
    assert rest == {name: round(float(np.degrees(angle)), 2) for name, angle in angles.items()}


@pytest.mark.parametrize(
    ("gaps", "tilt"),
    [
        ([0.025], 6.0),
        ([0.024, 0.026], 10.0),
        ([0.01] * 2 + [0.03], 15.0),
        ([0.01] * 3 + [0.03], 20.0),
        ([0.01] * 4 + [0.03], 27.0),
        ([0.01] * 6, 35.0),
    ],
)
def test_resting_arms_are_tilted_until_their_gap_to_the_body_is_2_5_cm_or_the_tilt_is_35_degrees(
    monkeypatch, gaps, tilt
):
    left = iter(gaps)
    monkeypatch.setattr(resting, "robot_from_tables", lambda file, path: (file.rest, path))
    monkeypatch.setattr(resting, "Robot", SimpleNamespace(of=lambda tables: tables))
    tried = []
    monkeypatch.setattr(resting, "_measure_arm_gap", lambda tables: tried.append(tables) or next(left))
    monkeypatch.setattr(resting, "_rest_arms", lambda figure, hinges, angle: {"arm": float(angle), "b": 0.0, "c": 1.0})
    hinges = (hinge("c", 0.1, 1.0), hinge("d", 0.1, 1.0))
    rest = rest_pose(None, hinges, File(CollisionTable(0.01)), "path")
    assert rest == {"arm": pytest.approx(radians(tilt)), "c": 1.0, "d": 5.73}
    assert len(tried) == len(gaps)
    assert tried[-1] == (rest | {"b": 0.0}, "path")


PAIRS = (("l_elbow", "trunk"), ("trunk", "r_wrist"), ("l_shoulder", "trunk"), ("r_elbow", "l_wrist"))


def stub_distances(monkeypatch, gaps, asked):
    monkeypatch.setattr(
        resting,
        "CapsuleDistances",
        lambda robot: SimpleNamespace(gaps=lambda postures: asked.append(postures) or np.array(gaps)),
    )


@pytest.mark.parametrize(
    ("gaps", "least"), [((0.3, 0.2, 0.1, 0.4), 0.2), ((0.15, 0.2, 0.1, 0.4), 0.15), ((0.3, 0.2, 0.1, -0.4), -0.4)]
)
def test_arm_gap_is_the_smallest_distance_of_forearms_and_hands(monkeypatch, gaps, least):
    asked = []
    stub_distances(monkeypatch, [gaps, (-9.0,) * 4], asked)
    robot = SimpleNamespace(skeleton=SimpleNamespace(rest=np.array([1.0, 2.0])), counted_pairs=PAIRS)
    assert _measure_arm_gap(robot) == least
    assert asked[0].tolist() == [[1.0, 2.0]]


def test_segment_pairs_close_at_rest_or_overlapping_in_most_postures_are_not_checked_for_collision(monkeypatch):
    postures, asked = [], []
    gaps = np.full((100, 5), 0.1)
    gaps[0, :2] = 0.0179, 0.0181
    gaps[1:92, 2] = -0.1
    gaps[1:91, 3] = -0.1
    gaps[1:92, 4] = 0.0
    stub_distances(monkeypatch, gaps, asked)
    monkeypatch.setattr(resting, "robot_from_tables", lambda file, path: (file, path))
    robot = SimpleNamespace(skeleton="skeleton", counted_pairs=[(name, "x") for name in "abcde"])
    monkeypatch.setattr(resting, "Robot", SimpleNamespace(of=lambda tables: robot))
    monkeypatch.setattr(resting, "random_postures", lambda *arguments: postures.append(arguments) or "postures")
    known = ExclusionTable(("p", "q"), "known")
    file = with_exclusions(File(CollisionTable(0.01, [known]), {"h": 1.0}), "path")
    assert (postures, asked) == ([("skeleton", 300)], ["postures"])
    assert file.rest == {"h": 1.0}
    assert file.collision.clearance == 0.01
    assert file.collision.exclude == [
        known,
        ExclusionTable(("a", "x"), "18 mm apart at rest: their shapes are rough"),
        ExclusionTable(("c", "x"), "overlap in 91 % of random postures"),
    ]

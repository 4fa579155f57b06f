"""Tests of each compiled stage of the arm solver against Python."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from kinesic.body.robot import Robot
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.seeds import seeds
from kinesic.ik.arm.subproblems import first_of_two, turn_towards
from kinesic.ik.arm.swivel import swivel_of
from kinesic.ik.scalar3 import Vector, unit, vector

from ..reference.ik.hinges import extract
from ..reference.ik.masses import settle_masses
from ..reference.ik.multistart import MAX_RESTARTS, nearest_seeds
from ..reference.ik.polish import polish
from ..reference.ik.shoulder_elbow import bend_elbow, gap, place_shoulder
from ..reference.ik.swivel import elbow_at
from ..reference.ik.track import soften_target
from ..reference.ik.wrist import HandDirection, orient

ARM_CHAIN = Robot.load().arms["l"]  # chain of the left arm
ARM_LINKAGE = linkage_of(ARM_CHAIN)  # linkage of the left arm
ANGLE_TOLERANCE = 1e-9  # [rad] accepted difference of kernel and reference


def _numbers(nested: object) -> Iterator[float]:
    if isinstance(nested, list | tuple):
        for part in nested:
            yield from _numbers(part)
    elif nested is not None:
        assert isinstance(nested, float | int)
        yield float(nested)


def _agree(specified: object, compiled: object) -> None:
    assert list(_numbers(compiled)) == pytest.approx(
        list(_numbers(specified)), abs=ANGLE_TOLERANCE, rel=ANGLE_TOLERANCE
    )


def _posture(random: Generator) -> list[float]:
    posture: list[float] = random.uniform(ARM_CHAIN.lower, ARM_CHAIN.upper).tolist()
    return posture


def _directions(random: Generator, count: int) -> list[Vector]:
    return [unit(vector(random.normal(size=3))) for _ in range(count)]


def test_compiled_forward_kinematics_equal_the_python_reference() -> None:
    random, arm = default_rng(1), arm_of(ARM_CHAIN)
    for _ in range(100):
        posture = _posture(random)
        _agree(ARM_LINKAGE.walk(posture, 4), arm.walk(posture, 4))


@pytest.mark.parametrize("bones", [2, 3, 5])
def test_compiled_settled_chain_masses_equal_the_python_reference(bones: int) -> None:
    random, arm = default_rng(2), arm_of(ARM_CHAIN)
    for _ in range(50):
        points = [vector(point) for point in random.normal(size=(bones + 1, 3))]
        lengths, target = random.uniform(0.5, 1.5, bones).tolist(), vector(random.normal(size=3))
        settled = settle_masses(points, lengths, target)
        _agree((settled.points, settled.iterations, settled.energy), arm.settle(points, lengths, target))
    straight = [(0.0, 0.0, -0.3 * k) for k in range(bones + 1)]
    settled = settle_masses(straight, [0.3] * bones, (0.0, 0.0, -0.2))
    _agree((settled.points, settled.iterations, settled.energy), arm.settle(straight, [0.3] * bones, (0.0, 0.0, -0.2)))


def test_compiled_paden_kahan_subproblems_equal_the_python_reference() -> None:
    random, arm = default_rng(3), arm_of(ARM_CHAIN)
    for _ in range(200):
        first, second, rest, wanted = _directions(random, 4)
        _agree(turn_towards(first, rest, wanted), arm.turn_towards(first, rest, wanted))
        _agree(first_of_two(first, second, rest, wanted), tuple(arm.first_of_two(first, second, rest, wanted)))
    x, y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    assert arm.turn_towards(x, x, y) is None
    assert arm.first_of_two(x, y, x, x) == []


def test_compiled_joint_angles_from_bone_directions_equal_the_python_reference() -> None:
    random, arm = default_rng(4), arm_of(ARM_CHAIN)
    for _ in range(150):
        points = ARM_LINKAGE.walk(_posture(random), 3)[1][1:]
        near = _posture(random)
        shaken = [vector(np.add(point, 0.05 * random.normal(size=3))) for point in points]
        for given in (points, shaken, points[:1]):
            extracted = extract(ARM_LINKAGE, given, near)
            _agree((extracted.angles, extracted.miss), arm.extract(given, near))


def test_compiled_elbow_positions_equal_the_python_reference() -> None:
    random, arm = default_rng(5), arm_of(ARM_CHAIN)
    for _ in range(100):
        shoulder, elbow, hand = ARM_LINKAGE.walk(_posture(random), 3)[1][-3:]
        swivel = random.uniform(-3, 3)
        _agree(swivel_of(ARM_LINKAGE, (shoulder, elbow, hand)), arm.swivel_of((shoulder, elbow, hand)))
        _agree(elbow_at(ARM_LINKAGE, shoulder, hand, swivel), arm.elbow_at(shoulder, hand, swivel))
    straight = [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.6, 0.0, 0.0)]
    assert arm.swivel_of(straight) is None


@pytest.mark.parametrize("size", [0.3, 0.55, 1.5])
def test_compiled_shoulder_and_elbow_placement_equal_the_python_reference(size: float) -> None:
    random, arm = default_rng(6), arm_of(ARM_CHAIN)
    for swivel in (None, 0.4, 2.8, None, -1.0) * 12:
        near, rest, (direction,) = _posture(random), _posture(random), _directions(random, 1)
        target = vector(np.array(ARM_LINKAGE.origin) + size * np.array(direction))
        place = place_shoulder(ARM_LINKAGE, target, near=near, rest=rest)
        _agree((place.girdle, place.shoulder, place.target, place.iterations), arm.placed(target, near, rest))
        bend = bend_elbow(ARM_LINKAGE, place, near=near, swivel=swivel)
        result = arm.bent(place.girdle, place.shoulder, place.target, near, swivel)
        _agree((bend.angles, bend.iterations), (result[0], result[2]))
        assert bend.exact == result[1]


def test_compiled_shoulder_target_distance_equals_the_python_reference() -> None:
    random, arm = default_rng(11), arm_of(ARM_CHAIN)
    for size in np.linspace(0.05, 2.0, 60):
        target = vector(np.array(ARM_LINKAGE.origin) + size * np.array(_directions(random, 1)[0]))
        _agree(gap(ARM_LINKAGE, target), arm.gap(target))


def test_compiled_damped_least_squares_correction_of_arm_angles_equals_the_python_reference() -> None:
    random, arm = default_rng(7), arm_of(ARM_CHAIN)
    for _ in range(100):
        target, angles, posture = vector(ARM_CHAIN.hand(np.array(_posture(random)))), _posture(random), _posture(random)
        for mobility in (ARM_LINKAGE.mobility, (0.0, *ARM_LINKAGE.mobility[1:])):
            polished = polish(ARM_LINKAGE, target, angles, posture=posture, mobility=mobility)
            _agree((polished.angles, polished.miss, polished.rounds), arm.polish(target, angles, posture, mobility))


def test_compiled_multistart_postures_equal_the_python_reference() -> None:
    random, arm = default_rng(8), arm_of(ARM_CHAIN)
    for _ in range(50):
        target = vector(random.uniform(-0.6, 0.6, 3))
        chosen = [seeds(ARM_LINKAGE)[k].angles for k in arm.nearest(target)]
        assert chosen == [seed.angles for seed in nearest_seeds(ARM_LINKAGE, target, MAX_RESTARTS)]


@pytest.mark.parametrize("count", [0, 1, 2])
def test_compiled_wrist_angles_equal_the_python_reference(count: int) -> None:
    random, arm, link = default_rng(9), arm_of(ARM_CHAIN), ARM_LINKAGE.links[-1]
    for _ in range(60):
        frame = ARM_LINKAGE.walk(_posture(random), 3)[0]
        own, wanted = _directions(random, count), _directions(random, count)
        wishes = [HandDirection(str(k), *pair) for k, pair in enumerate(zip(own, wanted, strict=True))]
        rest = _posture(random)[link.first :]
        _agree(orient(link, frame, wishes, rest), tuple(arm.orient(frame, own, wanted, rest)))


def test_compiled_soft_limit_of_arm_reach_equals_the_python_reference() -> None:
    random, arm = default_rng(10), arm_of(ARM_CHAIN)
    for size in np.linspace(0.3, 1.2, 40):
        target = vector(np.array(ARM_LINKAGE.origin) + size * np.array(_directions(random, 1)[0]))
        _agree(soften_target(ARM_LINKAGE, target, ARM_CHAIN.rest.tolist()), tuple(arm.softened(target)))

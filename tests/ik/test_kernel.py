"""Tests of the compiled arm solver against its Python reference."""

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from kinesic.bench.ik.arms import random_arm
from kinesic.body.arrays import sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Hinge
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.solve import Solution, solve

from ..reference.ik import solve as reference

DEFAULT_ROBOT = Robot.load()
LEFT_ARM = DEFAULT_ROBOT.arms["l"]  # chain of the left arm
RIGHT_ARM = DEFAULT_ROBOT.arms["r"]  # chain of the right arm
AXIS_VECTORS = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}  # unit vector by letter


def _hinges(segment: str, axes: str, ranges: list[tuple[float, float]]) -> tuple[Hinge, ...]:
    pairs = zip(axes, ranges, strict=True)
    return tuple(Hinge(f"{segment}{k}", segment, sealed(AXIS_VECTORS[a]), *r, 0.0) for k, (a, r) in enumerate(pairs))


def _reach(random: Generator, chain: Chain, k: int) -> Reach:
    """Return a random target: position, pointing, palm, or out of reach."""
    position = chain.hand(random.uniform(chain.lower, chain.upper)) * (1.4 if k % 10 == 9 else 1.0)
    match k % 4:
        case 0:
            return Reach(position, pointing=random.normal(size=3))
        case 1:
            return Reach(position, palm=random.normal(size=3), swivel=random.uniform(-1, 2))
        case 2:
            return Reach(position, pointing=random.normal(size=3), palm=random.normal(size=3))
        case _:
            return Reach(position)


def _same(specified: Solution, compiled: Solution) -> bool:
    """Return whether all numbers are equal."""
    return (
        bool(np.abs(specified.angles - compiled.angles).max() < 1e-9)
        and bool(np.abs(specified.target - compiled.target).max() < 1e-9)
        and abs(specified.residual - compiled.residual) < 1e-9
        and abs((specified.pointing_error or 0.0) - (compiled.pointing_error or 0.0)) < 1e-7
        and abs((specified.palm_error or 0.0) - (compiled.palm_error or 0.0)) < 1e-7
        and (specified.pointing_error is None) == (compiled.pointing_error is None)
        and (specified.palm_error is None) == (compiled.palm_error is None)
        and specified.iterations == compiled.iterations
    )


def _agreement(chain: Chain, count: int, seed: int) -> int:
    """Return the fraction of solutions equal to the reference solutions."""
    random, agreed = default_rng(seed), 0
    for k in range(count):
        start = random.uniform(chain.lower, chain.upper) if k % 2 else chain.rest
        rest = random.uniform(chain.lower - 0.1, chain.upper + 0.1) if k % 3 == 0 else None
        mobility = random.uniform(0.0, 1.0, len(chain.rest)) if k % 5 == 0 else None
        reach = _reach(random, chain, k)
        specified = reference.solve(chain, reach, start=start, rest=rest, mobility=mobility)
        compiled = solve(chain, reach, start=start, rest=rest, mobility=mobility)
        assert np.all((chain.lower <= compiled.angles) & (compiled.angles <= chain.upper))
        assert compiled.reached == specified.reached
        agreed += _same(specified, compiled)
    return agreed


@pytest.mark.parametrize("chain", [LEFT_ARM, RIGHT_ARM], ids=["left", "right"])
def test_compiled_arm_solutions_equal_the_python_reference(chain: Chain) -> None:
    assert _agreement(chain, 80, 21) == 80


def test_compiled_solutions_of_random_arms_equal_the_python_reference() -> None:
    random = default_rng(22)
    assert sum(_agreement(random_arm(random), 8, seed) for seed in range(12)) == 12 * 8


def test_at_least_99_8_percent_of_feasible_targets_are_reached_within_100_um() -> None:
    random = default_rng(23)
    for chain in (LEFT_ARM, RIGHT_ARM, *(random_arm(random) for _ in range(8))):
        count, precise = 100, 0
        for _ in range(count):
            position = chain.hand(random.uniform(chain.lower, chain.upper))
            angles = solve(chain, Reach(position), start=chain.rest).angles
            assert np.all((chain.lower <= angles) & (angles <= chain.upper))
            precise += bool(np.linalg.norm(chain.hand(angles) - position) < 1e-4)
        assert precise >= 0.998 * count, chain.name


def test_repeated_ik_kernel_calls_give_identical_bytes() -> None:
    random = default_rng(24)
    for k in range(100):
        reach = _reach(random, LEFT_ARM, k)
        one, two = (solve(LEFT_ARM, reach, start=LEFT_ARM.rest) for _ in range(2))
        assert one.angles.tobytes() == two.angles.tobytes()
        assert one.iterations == two.iterations


def test_ik_solution_has_read_only_arrays_and_plain_python_types() -> None:
    solution = solve(LEFT_ARM, Reach(LEFT_ARM.hand(LEFT_ARM.rest)), start=LEFT_ARM.rest)
    assert not solution.angles.flags.writeable
    assert not solution.target.flags.writeable
    assert type(solution.residual) is float
    assert type(solution.reached) is bool
    assert type(solution.iterations) is int


def test_ik_kernel_clips_a_start_posture_outside_the_ranges() -> None:
    reach, out = Reach(LEFT_ARM.hand(LEFT_ARM.rest + 0.1)), LEFT_ARM.upper + 3.0
    inside = solve(LEFT_ARM, reach, start=LEFT_ARM.upper)
    assert np.array_equal(solve(LEFT_ARM, reach, start=out).angles, inside.angles)


def test_ik_solution_is_equal_for_integer_and_strided_input_arrays() -> None:
    position = LEFT_ARM.hand(LEFT_ARM.rest + 0.1)
    plain = solve(LEFT_ARM, Reach(position), start=np.zeros(8))
    for strange in (np.repeat(position, 2)[::2], np.array(position, dtype=">f8")):
        assert np.array_equal(solve(LEFT_ARM, Reach(strange), start=np.zeros(8)).angles, plain.angles)
    whole = solve(LEFT_ARM, Reach(position), start=np.zeros(8, dtype=np.int64))
    assert np.array_equal(whole.angles, plain.angles)


@pytest.mark.parametrize("odd", [None, 3.0, np.zeros((3, 1)), np.zeros(2), np.array([0.0, np.nan, 0.0])])
def test_invalid_ik_target_position_raises_a_clear_error(odd: object) -> None:
    with pytest.raises(ValueError, match=r"reach\.position"):
        solve(LEFT_ARM, Reach(odd), start=LEFT_ARM.rest)  # type: ignore[arg-type]  # that is the question


def test_arm_data_of_a_chain_are_packed_once() -> None:
    assert arm_of(LEFT_ARM) is arm_of(LEFT_ARM)
    assert arm_of(LEFT_ARM) is not arm_of(RIGHT_ARM)


def test_joint_with_more_than_two_swing_hinges_raises_an_error() -> None:
    hinges = _hinges("wrist", "xyz" * 4, [(-1.0, 1.0)] * 12)
    joints = (*LEFT_ARM.joints[:-1], ChainJoint("wrist", hinges, sealed([0, 0, -0.08])))
    with pytest.raises(ValueError, match="at most two may"):
        arm_of(Chain("many", "trunk", LEFT_ARM.origin_in_base, joints, tuple(range(18)), LEFT_ARM.palm))

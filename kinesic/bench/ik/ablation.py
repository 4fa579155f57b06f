"""Ablation study of the IK solver: its stages measured separately.

Every row solves the same targets, with only some of the stages.

The compiled stages run one after another. Only rows that are one call of the solver are timed. There are no goals. The
plots show the solver on one target, and the success without some of its stages.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from numpy.random import default_rng

from kinesic.bench.ik.arms import draw_targets
from kinesic.bench.metric import (
    CONTRAST_COLOUR,
    INK_COLOUR,
    LABEL_SIZE,
    MAIN_COLOUR,
    OTHER_COLOUR,
    SECOND_COLOUR,
    Metric,
    name_rows,
    picture,
)
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.arm.linkage import Link, Linkage, linkage_of
from kinesic.ik.arm.multistart import approach, reach, reach_many
from kinesic.ik.arm.seeds import seeds
from kinesic.ik.arm.subproblems import first_of_two, turn_towards
from kinesic.ik.scalar3 import IDENTITY_ROTATION, Vector, distance, minus, rotated, turned, unit, vector, within
from kinesic.ik.solve import solve

TARGET_COUNT = 2000  # hand targets per ablation row
STRICT_POSITION_ERROR = 1e-4  # [m] strict bound of the hand's position error
LOOSE_POSITION_ERROR = 1e-3  # [m] loose bound of the hand's position error

USER_ENTRIES = ("polish_seeds", "whole")  # ablation rows that run kinesic's public functions, one target at a time
DRAWN_TARGET = (0.075, -0.064, 0.164)  # [m] hand target of the plot, in the frame of the chain's base
SWIVEL_SAMPLES = 73  # drawn points on the elbow's circle
PALE_COLOUR = "#bbbbbb"  # colour of the rest posture and the elbow's circle
MISS_WEIGHT = 1e3  # cost of a distance of one bone length between a bone's end and its target
TRAVEL_WEIGHT = 1e-3  # cost per radian of joint travel
EXACT_MISS = 1e-6  # hand error / reach below which a posture counts as exact

ArmSolver = Callable[["AblationArm", Floats], Sequence[float] | Floats]


@dataclass(frozen=True, eq=False)
class AblationArm:
    """Arm of the IK ablation, with the start posture of all solves."""

    chain: Chain
    linkage: Linkage
    rest: tuple[float, ...]  # [rad]


def bench() -> list[Metric]:
    """Measure success, travel and time of every ablation row."""
    chain = Robot.load().arms["l"]
    arm = AblationArm(chain, linkage_of(chain), tuple(chain.rest.tolist()))
    arm_targets = draw_targets(default_rng(93), chain, TARGET_COUNT)
    return [metric for name, row in ABLATION_ROWS.items() for metric in _metrics(name, row.answer, arm, arm_targets)]


def ablation_name(row: str, quantity: Literal["mm", "tenth_mm", "travel", "us"]) -> str:
    """Return the metric name of one ablation row and quantity."""
    return f"ik.ablation_{row}_{quantity}"


def _metrics(row: str, answer: ArmSolver, arm: AblationArm, arm_targets: Floats) -> list[Metric]:
    misses: list[float] = []
    travels: list[float] = []
    seconds: list[float] = []
    for target in arm_targets:
        began = perf_counter()
        solution = answer(arm, target)
        seconds.append(perf_counter() - began)
        angles = np.array([*solution, *arm.rest[len(solution) :]])
        misses.append(float(np.linalg.norm(arm.chain.hand(angles) - target)))
        travels.append(float(np.abs(angles - arm.chain.rest).sum()))
    metrics = [
        Metric(
            ablation_name(row, "mm"), float(np.mean(np.array(misses) < LOOSE_POSITION_ERROR)), "share", None, "higher"
        ),
        Metric(
            ablation_name(row, "tenth_mm"),
            float(np.mean(np.array(misses) < STRICT_POSITION_ERROR)),
            "share",
            None,
            "higher",
        ),
        Metric(ablation_name(row, "travel"), median(travels), "rad", None, "lower"),
    ]
    if row in USER_ENTRIES:
        metrics.append(Metric(ablation_name(row, "us"), 1e6 * median(seconds), "us", None, "lower"))
    return metrics


def settle_bone_ends(arm: AblationArm, target: Vector) -> list[Sequence[float]]:
    """Return the arm's bone ends [m] by the mass-spring model.

    The model ignores the elbow's range.
    """
    girdle, shoulder, hand, _ = arm_of(arm.chain).placed(target, arm.rest, arm.rest)
    elbow = arm.linkage.walk(arm.rest, len(arm.linkage.links) - 2)[1][-1]
    lengths = [link.length for link in arm.linkage.links[-3:-1]]
    points, _, _ = arm_of(arm.chain).settle((shoulder, elbow, hand), lengths, hand)
    return [*girdle, *points[1:]]


def guess_angles(arm: AblationArm, points: Sequence[Sequence[float]]) -> tuple[float, ...]:
    """Compute joint angles [rad] from bone ends, bone by bone without backtracking."""
    angles: tuple[float, ...] = ()
    for count, (link, point) in enumerate(zip(arm.linkage.links, points, strict=False)):
        frame, ends = arm.linkage.walk(angles, count)
        goal = within(frame, minus(vector(np.array(point)), ends[-1]))
        start = arm.rest[link.first : link.first + len(link.pivots)]
        branches = _aim_bone(link, unit(goal), start)
        angles += min(branches, key=lambda turns: _branch_cost(link, goal, turns, start))
    return angles


def _aim_bone(link: Link, direction: Vector, start: Sequence[float]) -> list[tuple[float, ...]]:
    """Return up to two joint-angle solutions [rad] that aim a bone.

    Joints before the last two keep their start angles.
    """
    if not start:
        return [()]
    fixed = tuple(start[:-2])
    for pivot, angle in zip(link.pivots, fixed, strict=False):
        direction = turned(direction, pivot.axis, -angle)
    last = link.pivots[-1]
    if len(start) == 1:
        aimed = turn_towards(last.axis, link.along, direction)
        return [(start[-1] if aimed is None else last.bring_into_range(aimed, start[-1]),)]
    first, branches = link.pivots[-2], []
    for branch in first_of_two(first.axis, last.axis, link.along, direction) or (start[-2],):
        angle = first.bring_into_range(branch, start[-2])
        aimed = turn_towards(last.axis, link.along, turned(direction, first.axis, -angle))
        branches.append((*fixed, angle, start[-1] if aimed is None else last.bring_into_range(aimed, start[-1])))
    return branches


def _branch_cost(link: Link, goal: Vector, angles: Sequence[float], start: Sequence[float]) -> float:
    miss = distance(rotated(link.turn(IDENTITY_ROTATION, angles), link.bone), goal) / link.length
    travel = sum(abs(angle - begin) for angle, begin in zip(angles, start, strict=True))
    return MISS_WEIGHT * miss + TRAVEL_WEIGHT * travel


def _extract(arm: AblationArm, points: Sequence[Sequence[float]]) -> Sequence[float]:
    return arm_of(arm.chain).extract(points, arm.rest)[0]


def _solve_masses_guess(arm: AblationArm, target: Floats) -> Sequence[float]:
    return guess_angles(arm, settle_bone_ends(arm, vector(target)))


def _solve_masses_branches(arm: AblationArm, target: Floats) -> Sequence[float]:
    return _extract(arm, settle_bone_ends(arm, vector(target)))


def _solve_circle(arm: AblationArm, target: Floats) -> Sequence[float]:
    girdle, shoulder, hand, _ = arm_of(arm.chain).placed(vector(target), arm.rest, arm.rest)
    return arm_of(arm.chain).bent(girdle, shoulder, hand, arm.rest, None)[0]


def _solve_with_seeds(arm: AblationArm, target: Floats) -> Sequence[float]:
    start_angles, mobility = _solve_masses_branches(arm, target), arm.linkage.mobility
    solver, arm_seeds = arm_of(arm.chain), seeds(arm.linkage)
    return approach(solver, arm_seeds, vector(target), start_angles, posture=arm.rest, mobility=mobility)[0]


def _solve_polish(arm: AblationArm, target: Floats) -> Floats:
    rows, _ = reach_many(arm.chain, target[None], arm.chain.rest)
    return rows.ravel()


def _solve_polish_seeds(arm: AblationArm, target: Floats) -> Floats:
    angles = arm.chain.rest.copy()
    reach(arm.chain, target, angles)
    return angles


def _polish_from(arm: AblationArm, target: Floats, start_angles: Sequence[float]) -> Sequence[float]:
    mobility = arm.linkage.mobility
    return arm_of(arm.chain).polish(vector(target), start_angles, arm.rest, mobility)[0]


@dataclass(frozen=True)
class AblationRow:
    """One selection of IK solver stages with its plot label."""

    words: str  # label in the plot
    answer: ArmSolver  # solver of this row


ABLATION_ROWS = {
    "masses_guess": AblationRow("masses, one guess per bone", _solve_masses_guess),
    "masses_branches": AblationRow("masses, all branches", _solve_masses_branches),
    "circle": AblationRow("elbow's circle", _solve_circle),
    "masses_guess_polish": AblationRow(
        "masses, one guess, LM", lambda arm, goal: _polish_from(arm, goal, _solve_masses_guess(arm, goal))
    ),
    "masses_branches_polish": AblationRow(
        "masses, branches, LM", lambda arm, goal: _polish_from(arm, goal, _solve_masses_branches(arm, goal))
    ),
    "masses_branches_polish_seeds": AblationRow("masses, branches, LM, seeds", _solve_with_seeds),
    "polish": AblationRow("LM alone", _solve_polish),
    "polish_seeds": AblationRow("LM, seeds", _solve_polish_seeds),
    "whole": AblationRow(
        "the whole solver", lambda arm, goal: solve(arm.chain, Reach(goal), start=arm.chain.rest).angles
    ),
}


def draw(values: Mapping[str, float], path: Path) -> Path:
    """Draw one target's IK solution in two views, and the ablation results.

    Args:
        values: metric values by name, including those of `ablation.bench`.
        path: path of the PNG file.

    Returns:
        The path.

    Raises:
        KeyError: a metric of the ablation is missing.
    """
    chain = Robot.load().arms["l"]
    arm = AblationArm(chain, linkage_of(chain), tuple(chain.rest.tolist()))
    with picture(path, 12.5, 4.8) as drawn:
        first, second, third = drawn.subplots(1, 3, width_ratios=[1.0, 1.0, 1.1])
        _draw_masses(first, arm)
        _draw_circle(second, arm)
        _draw_bars(third, values)
    return path


def _draw_masses(axes: Axes, arm: AblationArm) -> None:
    ends = settle_bone_ends(arm, DRAWN_TARGET)
    limited = _extract(arm, ends)
    _draw_line(axes, _posture(arm, arm.rest), PALE_COLOUR, "at rest")
    _draw_line(axes, (arm.linkage.origin, *ends), MAIN_COLOUR, "masses and springs")
    _draw_line(axes, _posture(arm, limited), SECOND_COLOUR, "their joints within the ranges")
    _finish_axes(axes, "masses ignore the ranges")


def _draw_circle(axes: Axes, arm: AblationArm) -> None:
    """Draw the elbow's circle, its part within joint ranges, and the solution."""
    solver = arm_of(arm.chain)
    girdle, shoulder, hand, _ = solver.placed(DRAWN_TARGET, arm.rest, arm.rest)
    circle = [solver.elbow_at(shoulder, hand, swivel) for swivel in np.linspace(-np.pi, np.pi, SWIVEL_SAMPLES).tolist()]
    allowed = [
        elbow
        for elbow in circle
        if solver.extract((*girdle, elbow, hand), arm.rest)[1] <= EXACT_MISS * arm.linkage.farthest
    ]
    axes.plot([y for _, y, _ in circle], [z for _, _, z in circle], color=PALE_COLOUR, label="elbow's circle")
    axes.plot([y for _, y, _ in allowed], [z for _, _, z in allowed], ".", color=MAIN_COLOUR, label="within the ranges")
    solution = solve(arm.chain, Reach(np.array(DRAWN_TARGET)), start=arm.chain.rest)
    _draw_line(axes, _posture(arm, solution.angles.tolist()), OTHER_COLOUR, "the solution")
    _finish_axes(axes, "the nearest elbow within the ranges")


def _draw_bars(axes: Axes, values: Mapping[str, float]) -> None:
    for row, key in enumerate(ABLATION_ROWS):
        percent = 100.0 * values[ablation_name(key, "mm")]
        axes.barh(-row, percent, height=0.66, color=OTHER_COLOUR if key == "whole" else MAIN_COLOUR, zorder=2)
        axes.text(percent - 1.0, -row, f"{percent:.1f}", ha="right", va="center", fontsize=LABEL_SIZE, color="white")
    name_rows(axes, [row.words for row in ABLATION_ROWS.values()])
    axes.set_xlim(0.0, 100.0)
    axes.set_title("targets below 1 mm [%]", fontsize=10, color=INK_COLOUR)


def _posture(arm: AblationArm, angles: Sequence[float]) -> list[Vector]:
    return arm.linkage.walk(angles, len(arm.linkage.links) - 1)[1]


def _draw_line(axes: Axes, points: Sequence[Sequence[float]], colour: str, label: str) -> None:
    """Draw connected points [m], projected to the frontal plane."""
    axes.plot([y for _, y, _ in points], [z for _, _, z in points], "o-", color=colour, markersize=4, label=label)


def _finish_axes(axes: Axes, title: str) -> None:
    axes.plot(DRAWN_TARGET[1], DRAWN_TARGET[2], "+", color=CONTRAST_COLOUR, markersize=14, zorder=5, label="target")
    axes.set_title(title, fontsize=10, color=INK_COLOUR)
    axes.set_aspect("equal", adjustable="datalim")
    axes.invert_xaxis()
    axes.set_xlabel("left [m], seen from the front", fontsize=LABEL_SIZE)
    axes.set_ylabel("up [m]", fontsize=LABEL_SIZE)
    axes.tick_params(labelsize=LABEL_SIZE, length=2)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, fontsize=LABEL_SIZE, frameon=False)

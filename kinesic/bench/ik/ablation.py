"""Measures what each stage of the solver contributes: the same targets with some of its stages only.

The stages are the specification's, one after another; the compiled entries answer where a row is one of them, and
only those are timed. No goals: whatever the figures show is the answer. Drawn: the solver at work on one target,
and what is left of it without some of its stages.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from numpy.random import default_rng

from kinesic.bench.figure import ALARM, INK, OTHERS, OURS, SECOND, SMALL, Figure, name_rows, picture
from kinesic.bench.ik.arms import targets
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik import KERNEL
from kinesic.ik.arm.hinges import extract
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.masses import settle_masses
from kinesic.ik.arm.multistart import approach, reach, reach_many
from kinesic.ik.arm.polish import polish
from kinesic.ik.arm.shoulder_elbow import EXACT, bend_elbow, place_shoulder
from kinesic.ik.arm.swivel import elbow_at
from kinesic.ik.scalar3 import Vector, minus, vector, within
from kinesic.ik.solve import solve

TARGETS = {"compiled": 2000, "numpy": 60}
TENTH_MM, MM = 1e-4, 1e-3

ENTRIES = ("polish_seeds", "whole")  # one call for one target, as a user makes it
TARGET = (0.075, -0.064, 0.164)  # [m] of the hand, in the frame of the chain's base
SWIVELS = 73
PALE = "#bbbbbb"

ArmSolver = Callable[["AblationArm", Floats], Sequence[float] | Floats]


@dataclass(frozen=True, eq=False)
class AblationArm:
    """The arm that is asked, and where it begins each time."""

    chain: Chain
    linkage: Linkage
    rest: tuple[float, ...]  # [rad]


def bench() -> list[Figure]:
    """Measures shares, travel and times of every row."""
    chain = Robot.load().arms["l"]
    arm = AblationArm(chain, linkage_of(chain), tuple(chain.rest.tolist()))
    goals = targets(default_rng(93), chain, TARGETS[KERNEL])
    return [figure for name, row in ROWS.items() for figure in _figures(name, row.answer, arm, goals)]


def ablation_name(row: str, quantity: Literal["mm", "tenth_mm", "travel", "us"]) -> str:
    """Names a figure."""
    return f"ik.ablation_{row}_{quantity}"


def _figures(row: str, answer: ArmSolver, arm: AblationArm, goals: Floats) -> list[Figure]:
    misses: list[float] = []
    travels: list[float] = []
    seconds: list[float] = []
    for target in goals:
        began = perf_counter()
        found = answer(arm, target)
        seconds.append(perf_counter() - began)
        angles = np.array([*found, *arm.rest[len(found) :]])
        misses.append(float(np.linalg.norm(arm.chain.hand(angles) - target)))
        travels.append(float(np.abs(angles - arm.chain.rest).sum()))
    figures = [
        Figure(ablation_name(row, "mm"), float(np.mean(np.array(misses) < MM)), "share", None, "higher"),
        Figure(ablation_name(row, "tenth_mm"), float(np.mean(np.array(misses) < TENTH_MM)), "share", None, "higher"),
        Figure(ablation_name(row, "travel"), median(travels), "rad", None, "lower"),
    ]
    if row in ENTRIES and KERNEL == "compiled":
        figures.append(Figure(ablation_name(row, "us"), 1e6 * median(seconds), "us", None, "lower"))
    return figures


def masses(arm: AblationArm, target: Vector) -> tuple[Vector, ...]:
    """Settles the masses [m]: ends of the bones from the base to the hand; no elbow's range is known."""
    place = place_shoulder(arm.linkage, target, near=arm.rest, rest=arm.rest)
    elbow = arm.linkage.walk(arm.rest, len(arm.linkage.links) - 2)[1][-1]
    lengths = [link.length for link in arm.linkage.links[-3:-1]]
    return (*place.girdle, *settle_masses((place.shoulder, elbow, place.target), lengths, place.target).points[1:])


def guessed(arm: AblationArm, points: Sequence[Vector]) -> tuple[float, ...]:
    """Computes hinge angles [rad] from points greedily, bone by bone, without revising an earlier branch."""
    angles: tuple[float, ...] = ()
    for count, (link, point) in enumerate(zip(arm.linkage.links, points, strict=False)):
        frame, ends = arm.linkage.walk(angles, count)
        bone = Linkage((0.0, 0.0, 0.0), (replace(link, first=0),), arm.linkage.side, link.length, link.length)
        goal = within(frame, minus(point, ends[-1]))
        angles += extract(bone, [goal], arm.rest[link.first :]).angles
    return angles


def _masses_guess(arm: AblationArm, target: Floats) -> Sequence[float]:
    return guessed(arm, masses(arm, vector(target)))


def _masses_branches(arm: AblationArm, target: Floats) -> Sequence[float]:
    return extract(arm.linkage, masses(arm, vector(target)), arm.rest).angles


def _circle(arm: AblationArm, target: Floats) -> Sequence[float]:
    place = place_shoulder(arm.linkage, vector(target), near=arm.rest, rest=arm.rest)
    return bend_elbow(arm.linkage, place, near=arm.rest, swivel=None).angles


def _masses_branches_polish_seeds(arm: AblationArm, target: Floats) -> Sequence[float]:
    begin, mobility = _masses_branches(arm, target), arm.linkage.mobility
    return approach(arm.linkage, vector(target), begin, posture=arm.rest, mobility=mobility).angles


def _polish(arm: AblationArm, target: Floats) -> Floats:
    rows, _ = reach_many(arm.chain, target[None], arm.chain.rest)
    return rows.ravel()


def _polish_seeds(arm: AblationArm, target: Floats) -> Floats:
    angles = arm.chain.rest.copy()
    reach(arm.chain, target, angles)
    return angles


def _polished(arm: AblationArm, target: Floats, begin: Sequence[float]) -> Sequence[float]:
    mobility = arm.linkage.mobility
    return polish(arm.linkage, vector(target), begin, posture=arm.rest, mobility=mobility).angles


@dataclass(frozen=True)
class AblationRow:
    """One selection of stages."""

    words: str
    answer: ArmSolver


ROWS = {
    "masses_guess": AblationRow("masses, one guess each", _masses_guess),
    "masses_branches": AblationRow("masses, all branches", _masses_branches),
    "circle": AblationRow("elbow's circle", _circle),
    "masses_guess_polish": AblationRow(
        "masses, one guess, LM", lambda arm, goal: _polished(arm, goal, _masses_guess(arm, goal))
    ),
    "masses_branches_polish": AblationRow(
        "masses, branches, LM", lambda arm, goal: _polished(arm, goal, _masses_branches(arm, goal))
    ),
    "masses_branches_polish_seeds": AblationRow("masses, branches, LM, seeds", _masses_branches_polish_seeds),
    "polish": AblationRow("LM alone", _polish),
    "polish_seeds": AblationRow("LM, seeds", _polish_seeds),
    "whole": AblationRow(
        "the whole solver", lambda arm, goal: solve(arm.chain, Reach(goal), start=arm.chain.rest).angles
    ),
}


def draw(values: Mapping[str, float], path: Path) -> Path:
    """Draws one target's solution in two views, and the ablation.

    Args:
        values: figures by name, those of `ablation.bench` among them.
        path: of the picture, PNG.

    Returns:
        The path.

    Raises:
        KeyError: a figure of the ablation is missing.
    """
    chain = Robot.load().arms["l"]
    arm = AblationArm(chain, linkage_of(chain), tuple(chain.rest.tolist()))
    with picture(path, 12.5, 4.8) as drawn:
        first, second, third = drawn.subplots(1, 3, width_ratios=[1.0, 1.0, 1.1])
        _masses(first, arm)
        _draw_circle(second, arm)
        _bars(third, values)
    return path


def _masses(axes: Axes, arm: AblationArm) -> None:
    ends = masses(arm, TARGET)
    limited = extract(arm.linkage, ends, arm.rest).angles
    _line(axes, _posture(arm, arm.rest), PALE, "at rest")
    _line(axes, (arm.linkage.origin, *ends), OURS, "masses and springs")
    _line(axes, _posture(arm, limited), SECOND, "their hinges, inside the ranges")
    _dressed(axes, "masses know no ranges")


def _draw_circle(axes: Axes, arm: AblationArm) -> None:
    """The elbow's circle, the part that the ranges allow, and the answer."""
    place = place_shoulder(arm.linkage, TARGET, near=arm.rest, rest=arm.rest)
    circle = [
        elbow_at(arm.linkage, place.shoulder, place.target, swivel) for swivel in np.linspace(-np.pi, np.pi, SWIVELS)
    ]
    allowed = [
        elbow
        for elbow in circle
        if extract(arm.linkage, (*place.girdle, elbow, place.target), arm.rest).miss <= EXACT * arm.linkage.farthest
    ]
    axes.plot([y for _, y, _ in circle], [z for _, _, z in circle], color=PALE, label="elbow's circle")
    axes.plot([y for _, y, _ in allowed], [z for _, _, z in allowed], ".", color=OURS, label="inside the ranges")
    found = solve(arm.chain, Reach(np.array(TARGET)), start=arm.chain.rest)
    _line(axes, _posture(arm, found.angles.tolist()), OTHERS, "the answer")
    _dressed(axes, "the nearest elbow that the ranges allow")


def _bars(axes: Axes, values: Mapping[str, float]) -> None:
    for row, key in enumerate(ROWS):
        share = 100.0 * values[ablation_name(key, "mm")]
        axes.barh(-row, share, height=0.66, color=OTHERS if key == "whole" else OURS, zorder=2)
        axes.text(share - 1.0, -row, f"{share:.1f}", ha="right", va="center", fontsize=SMALL, color="white")
    name_rows(axes, [row.words for row in ROWS.values()])
    axes.set_xlim(0.0, 100.0)
    axes.set_title("targets below 1 mm [%]", fontsize=10, color=INK)


def _posture(arm: AblationArm, angles: Sequence[float]) -> list[Vector]:
    return arm.linkage.walk(angles, len(arm.linkage.links) - 1)[1]


def _line(axes: Axes, points: Sequence[Vector], colour: str, label: str) -> None:
    """Joints from the front: y to the left, z up [m]."""
    axes.plot([y for _, y, _ in points], [z for _, _, z in points], "o-", color=colour, markersize=4, label=label)


def _dressed(axes: Axes, title: str) -> None:
    axes.plot(TARGET[1], TARGET[2], "+", color=ALARM, markersize=14, zorder=5, label="target")
    axes.set_title(title, fontsize=10, color=INK)
    axes.set_aspect("equal", adjustable="datalim")
    axes.invert_xaxis()
    axes.set_xlabel("left [m], seen from the front", fontsize=SMALL)
    axes.set_ylabel("up [m]", fontsize=SMALL)
    axes.tick_params(labelsize=SMALL, length=2)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, fontsize=SMALL, frameon=False)

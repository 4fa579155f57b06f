"""What each stage of the solver contributes: the same targets with some of its stages only.

The stages are the specification's, one after another; the compiled entries answer where a row is one of them, and
only those are timed. No goals: whatever the figures show is the answer.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from statistics import median
from time import perf_counter
from typing import Literal

import numpy as np
from numpy.random import default_rng

from kinesic.bench.figure import Figure
from kinesic.bench.ik.arms import targets
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik import KERNEL
from kinesic.ik.arm.hinges import extract
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.masses import settle
from kinesic.ik.arm.multistart import approach, reach, reach_many
from kinesic.ik.arm.polish import polish
from kinesic.ik.arm.shoulder_elbow import bent, placed
from kinesic.ik.scalar3 import Vector, minus, vector, within
from kinesic.ik.solve import solve

TARGETS = {"compiled": 2000, "numpy": 60}
TENTH_MM, MM = 1e-4, 1e-3

Row = Literal[
    "masses_guess",
    "masses_branches",
    "circle",
    "masses_guess_polish",
    "masses_branches_polish",
    "masses_branches_polish_seeds",
    "polish",
    "polish_seeds",
    "whole",
]
Answer = Callable[["Arm", Floats], Sequence[float] | Floats]
ENTRIES: tuple[Row, ...] = ("polish_seeds", "whole")  # one call for one target, as a user makes it


@dataclass(frozen=True, eq=False)
class Arm:
    """The arm that is asked, and where it begins each time."""

    chain: Chain
    linkage: Linkage
    rest: tuple[float, ...]  # [rad]


def bench() -> list[Figure]:
    """Shares, travel and times of every row."""
    chain = Robot.load().arms["l"]
    arm = Arm(chain, linkage_of(chain), tuple(chain.rest.tolist()))
    asked = targets(default_rng(93), chain, TARGETS[KERNEL])
    return [figure for row, answer in ROWS.items() for figure in _figures(row, answer, arm, asked)]


def name(row: Row, quantity: Literal["mm", "tenth_mm", "travel", "us"]) -> str:
    """The name of a figure."""
    return f"ik.ablation_{row}_{quantity}"


def _figures(row: Row, answer: Answer, arm: Arm, asked: Floats) -> list[Figure]:
    misses: list[float] = []
    travels: list[float] = []
    seconds: list[float] = []
    for target in asked:
        began = perf_counter()
        found = answer(arm, target)
        seconds.append(perf_counter() - began)
        angles = np.array([*found, *arm.rest[len(found) :]])
        misses.append(float(np.linalg.norm(arm.chain.hand(angles) - target)))
        travels.append(float(np.abs(angles - arm.chain.rest).sum()))
    figures = [
        Figure(name(row, "mm"), float(np.mean(np.array(misses) < MM)), "share", None, "higher"),
        Figure(name(row, "tenth_mm"), float(np.mean(np.array(misses) < TENTH_MM)), "share", None, "higher"),
        Figure(name(row, "travel"), median(travels), "rad", None, "lower"),
    ]
    if row in ENTRIES and KERNEL == "compiled":
        figures.append(Figure(name(row, "us"), 1e6 * median(seconds), "us", None, "lower"))
    return figures


def masses(arm: Arm, target: Vector) -> tuple[Vector, ...]:
    """Where the masses come to rest [m]: ends of the bones from the base to the hand; no elbow's range is known."""
    place = placed(arm.linkage, target, near=arm.rest, rest=arm.rest)
    elbow = arm.linkage.walk(arm.rest, len(arm.linkage.links) - 2)[1][-1]
    lengths = [link.length for link in arm.linkage.links[-3:-1]]
    return (*place.girdle, *settle((place.shoulder, elbow, place.target), lengths, place.target).points[1:])


def guessed(arm: Arm, points: Sequence[Vector]) -> tuple[float, ...]:
    """Hinges from points, bone by bone: each takes its own best branch and never learns what comes of it [rad]."""
    angles: tuple[float, ...] = ()
    for count, (link, point) in enumerate(zip(arm.linkage.links, points, strict=False)):
        frame, ends = arm.linkage.walk(angles, count)
        bone = Linkage((0.0, 0.0, 0.0), (replace(link, first=0),), arm.linkage.side, link.length)
        goal = within(frame, minus(point, ends[-1]))
        angles += extract(bone, [goal], arm.rest[link.first :]).angles
    return angles


def _masses_guess(arm: Arm, target: Floats) -> Sequence[float]:
    return guessed(arm, masses(arm, vector(target)))


def _masses_branches(arm: Arm, target: Floats) -> Sequence[float]:
    return extract(arm.linkage, masses(arm, vector(target)), arm.rest).angles


def _circle(arm: Arm, target: Floats) -> Sequence[float]:
    place = placed(arm.linkage, vector(target), near=arm.rest, rest=arm.rest)
    return bent(arm.linkage, place, near=arm.rest, swivel=None).angles


def _masses_guess_polish(arm: Arm, target: Floats) -> Sequence[float]:
    return _polished(arm, target, _masses_guess(arm, target))


def _masses_branches_polish(arm: Arm, target: Floats) -> Sequence[float]:
    return _polished(arm, target, _masses_branches(arm, target))


def _masses_branches_polish_seeds(arm: Arm, target: Floats) -> Sequence[float]:
    begin, mobility = _masses_branches(arm, target), arm.linkage.mobility
    return approach(arm.linkage, vector(target), begin, posture=arm.rest, mobility=mobility).angles


def _polish(arm: Arm, target: Floats) -> Floats:
    rows, _ = reach_many(arm.chain, target[None], arm.chain.rest)
    return rows.ravel()


def _polish_seeds(arm: Arm, target: Floats) -> Floats:
    angles = arm.chain.rest.copy()
    reach(arm.chain, target, angles)
    return angles


def _whole(arm: Arm, target: Floats) -> Floats:
    return solve(arm.chain, Reach(target), start=arm.chain.rest).angles


def _polished(arm: Arm, target: Floats, begin: Sequence[float]) -> Sequence[float]:
    mobility = arm.linkage.mobility
    return polish(arm.linkage, vector(target), begin, posture=arm.rest, mobility=mobility).angles


ROWS: dict[Row, Answer] = {
    "masses_guess": _masses_guess,
    "masses_branches": _masses_branches,
    "circle": _circle,
    "masses_guess_polish": _masses_guess_polish,
    "masses_branches_polish": _masses_branches_polish,
    "masses_branches_polish_seeds": _masses_branches_polish_seeds,
    "polish": _polish,
    "polish_seeds": _polish_seeds,
    "whole": _whole,
}

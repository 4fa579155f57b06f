"""The rest of the reach protocol: other starts, travel, narrow ranges, paths at three rates, the elbow's swivel.

Drawn: how exact and how fast, how far the hinges turn, and how the elbow follows a path.
"""

from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np
from matplotlib.axes import Axes
from numpy.random import default_rng

from kinesic.bench.figure import ALARM, INK, OURS, SMALL, Figure, label_axes, picture
from kinesic.bench.ik.arms import targets
from kinesic.bench.ik.tracking import LAP, RATE, damped_least_squares, ellipse
from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik import KERNEL
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.solve import solve
from kinesic.ik.track import Tracker

TARGETS = {"compiled": 2000, "numpy": 100}
STARTS = 60  # whose best is the reference of travel
TRAVELLED = 100  # targets
TENTH_MM = 1e-4
RATES = (50, 200, 1000)  # [Hz]
DRAWN_TARGETS = 1500
FLOOR = 1e-17  # [m] what a miss of nothing is drawn as


def bench() -> list[Figure]:
    """Measures P2, P3, P4, P5 and P8 on upper22's left arm."""
    chain = Robot.load().arms["l"]
    return [*_starts(chain), *_travel(chain), *_narrowed(chain), *_rates(chain), *_swivel(chain)]


def _share(chain: Chain, start: Floats, goals: Floats) -> float:
    found = (solve(chain, Reach(target), start=start) for target in goals)
    return float(np.mean([solution.residual < TENTH_MM for solution in found]))


def _starts(chain: Chain) -> list[Figure]:
    """P2: the straight arm, the arm held out to the side, and the corners of the ranges."""
    goals = targets(default_rng(2), chain, TARGETS[KERNEL])
    out = np.zeros(len(chain.rest))
    out[2] = np.pi / 2
    starts = {"straight": np.zeros_like(out), "aside": out, "lower_corner": chain.lower, "upper_corner": chain.upper}
    return [
        Figure(f"ik.success_from_{name}", _share(chain, start, goals), "share", 0.9999, "higher")
        for name, start in starts.items()
    ]


def _travel(chain: Chain) -> list[Figure]:
    """P3: turning from rest, over the least of many starts that also reach."""
    chance = default_rng(3)
    total, largest = [], []
    for target in targets(chance, chain, TRAVELLED):
        reach = Reach(target)
        starts = [chain.rest, *(chance.uniform(chain.lower, chain.upper) for _ in range(STARTS))]
        moves = [np.abs(solve(chain, reach, start=start).angles - chain.rest) for start in starts]
        total.append(moves[0].sum() / max(min(move.sum() for move in moves), 1e-9))
        largest.append(moves[0].max() / max(min(move.max() for move in moves), 1e-9))
    return [
        Figure("ik.travel_over_best", float(np.median(total)), "x", None, "lower", f"best of {STARTS} starts"),
        Figure("ik.largest_turn_over_best", float(np.median(largest)), "x", None, "lower"),
    ]


def _narrowed(chain: Chain) -> list[Figure]:
    """P8: the same arm with 60 and 35 % of its ranges about their middles."""
    figures = []
    for share in (0.6, 0.35):
        narrow = _with_ranges(chain, share)
        goals = targets(default_rng(8), narrow, TARGETS[KERNEL])
        met = _share(narrow, narrow.rest, goals)
        figures.append(Figure(f"ik.success_ranges_{round(100 * share)}", met, "share", 0.999, "higher"))
    return figures


def _with_ranges(chain: Chain, share: float) -> Chain:
    joints = []
    for joint in chain.joints:
        hinges = []
        for hinge in joint.hinges:
            middle, half = (hinge.upper + hinge.lower) / 2, share * (hinge.upper - hinge.lower) / 2
            rest = float(np.clip(hinge.rest, middle - half, middle + half))
            hinges.append(replace(hinge, lower=middle - half, upper=middle + half, rest=rest))
        joints.append(replace(joint, hinges=tuple(hinges)))
    return replace(chain, joints=tuple(joints))


def _laps(chain: Chain, rate: int) -> Floats:
    """(steps, k) [rad] of the second lap of the ellipse."""
    tracker = Tracker(chain, period=1 / rate)
    steps = round(LAP * rate)
    rows = [tracker.step(ellipse(2 * np.pi * (step % steps) / steps)) for step in range(2 * steps)]
    return sealed(rows[steps:])


def _rates(chain: Chain) -> list[Figure]:
    """P4: the same lap at three rates, as the largest difference over the range of angles."""
    slow, *others = (_laps(chain, rate)[:: rate // RATES[0]] for rate in RATES)
    apart = max(float(np.abs(lap - slow).max()) for lap in others) / float(np.ptp(slow, axis=0).max())
    return [Figure("ik.tracking_rates_differ", apart, "share", 0.01, "lower", "50, 200 and 1000 Hz")]


def _swivel(chain: Chain) -> list[Figure]:
    """P5: how the elbow swings on a closed path."""
    swings = np.unwrap([found for row in _laps(chain, 200) if (found := swivel(chain, row)) is not None])
    return [
        Figure("ik.swivel_spread", float(np.std(swings)), "rad", None, "lower", "standard deviation over a lap"),
        Figure("ik.swivel_step", float(np.abs(np.diff(swings)).max()), "rad", None, "lower", "largest, at 200 Hz"),
    ]


def draw(path: Path) -> Path:
    """Measures and draws; returns the path of the PNG."""
    chain = Robot.load().arms["l"]
    misses, seconds, travel = _solved(chain)
    with picture(path, 11.0, 6.4) as drawn:
        axes = drawn.subplots(2, 2)
        _shares(axes[0, 0], 1000 * misses + FLOOR, "miss of the hand [mm]", "P1: 0.1 mm is the goal", goal=0.1)
        _shares(axes[0, 1], 1e6 * seconds, "time of one solve from Python [us]", "P1")
        _shares(axes[1, 0], travel, "turning from rest, sum over hinges [rad]", "P3", logarithmic=False)
        _lap(axes[1, 1], chain)
    return path


def _solved(chain: Chain) -> tuple[Floats, Floats, Floats]:
    """Misses [m], times [s] and travels [rad] of seeded targets, (TARGETS,) each."""
    rows = []
    for target in targets(default_rng(1), chain, DRAWN_TARGETS):
        began = perf_counter()
        angles = solve(chain, Reach(target), start=chain.rest).angles
        took = perf_counter() - began
        rows.append((np.linalg.norm(chain.hand(angles) - target), took, np.abs(angles - chain.rest).sum()))
    misses, seconds, travel = np.array(rows).T
    return misses, seconds, travel


def _shares(
    axes: Axes, values: Floats, label: str, title: str, *, goal: float | None = None, logarithmic: bool = True
) -> None:
    axes.plot(np.sort(values), np.arange(1, len(values) + 1) / len(values), color=OURS)
    if logarithmic:
        axes.set_xscale("log")
    if goal is not None:
        axes.axvline(goal, color=ALARM, linewidth=0.8)
    label_axes(axes, label, "share of targets", title=title)
    axes.grid(alpha=0.3)


def _lap(axes: Axes, chain: Chain) -> None:
    steps = round(LAP * RATE)
    tracker = Tracker(chain, period=1 / RATE)
    ours = np.array([tracker.step(ellipse(2 * np.pi * step / steps)) for step in range(2 * steps)])
    plain = np.concatenate(damped_least_squares(chain, ellipse, steps, 2))
    times = np.arange(2 * steps) / RATE
    for hinge in range(1, 4):
        axes.plot(times, np.degrees(plain[:, hinge]), color=ALARM, linewidth=0.8, label="damped least squares")
        axes.plot(times, np.degrees(ours[:, hinge]), color=OURS, linewidth=1.2, label="tracker")
    axes.axvline(LAP, color=INK, linewidth=0.5)
    axes.legend(*(entries[:2] for entries in axes.get_legend_handles_labels()), fontsize=SMALL, frameon=False)
    title = "P4, P5: the second lap is the first again"
    label_axes(axes, "time on the ellipse, two laps [s]", "shoulder hinges [deg]", title=title)
    axes.grid(alpha=0.3)

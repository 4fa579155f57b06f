"""The reach protocol as pictures: how exact and how fast, how far the hinges turn, and how the elbow follows a path."""

from pathlib import Path
from time import perf_counter

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.random import default_rng

from kinesic.bench.ik.arms import targets
from kinesic.bench.ik.plain import damped_least_squares
from kinesic.bench.ik.tracking import LAP, RATE, ellipse
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.solve import solve
from kinesic.ik.track import Tracker

TARGETS = 1500
OURS, PLAIN, INK = "#2b7a78", "#b3261e", "#333333"
SMALL = 8.5  # [pt]
FLOOR = 1e-17  # [m] what a miss of nothing is drawn as


def draw(path: Path) -> Path:
    """Measures and draws; returns the path of the PNG."""
    chain = Robot.load().arms["l"]
    figure = Figure(figsize=(11.0, 6.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 2)
    misses, seconds, travel = _solved(chain)
    _shares(axes[0, 0], 1000 * misses + FLOOR, "miss of the hand [mm]", "P1: 0.1 mm is the goal", goal=0.1)
    _shares(axes[0, 1], 1e6 * seconds, "time of one solve from Python [us]", "P1")
    _shares(axes[1, 0], travel, "turning from rest, sum over hinges [rad]", "P3", logarithmic=False)
    _lap(axes[1, 1], chain)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    return path


def _solved(chain: Chain) -> tuple[Floats, Floats, Floats]:
    """Misses [m], times [s] and travels [rad] of seeded targets, (TARGETS,) each."""
    rows = []
    for target in targets(default_rng(1), chain, TARGETS):
        began = perf_counter()
        angles = solve(chain, Reach(target), start=chain.rest).angles
        took = perf_counter() - began
        rows.append((np.linalg.norm(chain.hand(angles) - target), took, np.abs(angles - chain.rest).sum()))
    misses, seconds, travel = np.array(rows).T
    return misses, seconds, travel


def _shares(
    axes: Axes, values: Floats, label: str, title: str, *, goal: float | None = None, logarithmic: bool = True
) -> None:
    """Share of targets below each value."""
    axes.plot(np.sort(values), np.arange(1, len(values) + 1) / len(values), color=OURS)
    if logarithmic:
        axes.set_xscale("log")
    if goal is not None:
        axes.axvline(goal, color=PLAIN, linewidth=0.8)
    axes.set_xlabel(label, fontsize=SMALL, color=INK)
    axes.set_ylabel("share of targets", fontsize=SMALL, color=INK)
    axes.set_title(title, fontsize=10, color=INK)
    axes.grid(alpha=0.3)


def _lap(axes: Axes, chain: Chain) -> None:
    """P4 and P5: the shoulder's hinges over two laps, against plain damped least squares."""
    steps = round(LAP * RATE)
    tracker = Tracker(chain, period=1 / RATE)
    ours = np.array([tracker.step(ellipse(2 * np.pi * step / steps)) for step in range(2 * steps)])
    plain = np.concatenate(damped_least_squares(chain, ellipse, steps, 2))
    times = np.arange(2 * steps) / RATE
    for hinge in range(1, 4):
        axes.plot(times, np.degrees(plain[:, hinge]), color=PLAIN, linewidth=0.8, label="damped least squares")
        axes.plot(times, np.degrees(ours[:, hinge]), color=OURS, linewidth=1.2, label="tracker")
    axes.axvline(LAP, color=INK, linewidth=0.5)
    axes.legend(*(entries[:2] for entries in axes.get_legend_handles_labels()), fontsize=SMALL, frameon=False)
    axes.set_xlabel("time on the ellipse, two laps [s]", fontsize=SMALL, color=INK)
    axes.set_ylabel("shoulder hinges [deg]", fontsize=SMALL, color=INK)
    axes.set_title("P4, P5: the second lap is the first again", fontsize=10, color=INK)
    axes.grid(alpha=0.3)

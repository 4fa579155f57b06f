"""Benchmark of reaching: start postures, joint travel, closed paths and narrowed ranges.

The plots show accuracy and time, the travel of the joints, and the joint angles on a path.
"""

from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np
from matplotlib.axes import Axes
from numpy.random import default_rng

from kinesic.bench.ik.arms import draw_targets
from kinesic.bench.ik.tracking import LAP_DURATION, TRACKING_RATE, damped_least_squares, ellipse
from kinesic.bench.metric import CONTRAST_COLOUR, INK_COLOUR, LABEL_SIZE, MAIN_COLOUR, Metric, label_axes, picture
from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.solve import solve
from kinesic.ik.track import Tracker

TARGET_COUNT = 2000  # hand targets per start posture
RANDOM_STARTS = 60  # number of random start postures; the smallest joint travel among these is the reference
TRAVEL_TARGETS = 100  # targets for which joint travel is measured
STRICT_POSITION_ERROR = 1e-4  # [m] strict bound of the hand's position error
TRACKING_RATES = (50, 200, 1000)  # [Hz] compared sample rates of a closed hand path
DRAWN_TARGETS = 1500  # hand targets whose errors are plotted
ERROR_FLOOR = 1e-17  # [mm] added to plotted errors, so that zero has a logarithm


def bench() -> list[Metric]:
    """Measure IK from varied starts, on closed paths and with narrowed ranges."""
    chain = Robot.load().arms["l"]
    return [
        *_measure_starts(chain),
        *_measure_travel(chain),
        *_measure_narrowed(chain),
        *_compare_rates(chain),
        *_measure_swivel(chain),
    ]


def _success_rate(chain: Chain, start: Floats, goals: Floats) -> float:
    solutions = (solve(chain, Reach(target), start=start) for target in goals)
    return float(np.mean([solution.residual < STRICT_POSITION_ERROR for solution in solutions]))


def _measure_starts(chain: Chain) -> list[Metric]:
    """Measure the IK success rate from four extreme start postures."""
    goals = draw_targets(default_rng(2), chain, TARGET_COUNT)
    out = np.zeros(len(chain.rest))
    out[2] = np.pi / 2
    starts = {"straight": np.zeros_like(out), "aside": out, "lower_corner": chain.lower, "upper_corner": chain.upper}
    return [
        Metric(f"ik.success_from_{name}", _success_rate(chain, start, goals), "share", 0.9999, "higher")
        for name, start in starts.items()
    ]


def _measure_travel(chain: Chain) -> list[Metric]:
    """Measure the solver's joint travel relative to the best of many starts."""
    rng = default_rng(3)
    total, largest = [], []
    for target in draw_targets(rng, chain, TRAVEL_TARGETS):
        reach = Reach(target)
        starts = [chain.rest, *(rng.uniform(chain.lower, chain.upper) for _ in range(RANDOM_STARTS))]
        travels = [np.abs(solve(chain, reach, start=start).angles - chain.rest) for start in starts]
        total.append(travels[0].sum() / max(min(move.sum() for move in travels), 1e-9))
        largest.append(travels[0].max() / max(min(move.max() for move in travels), 1e-9))
    return [
        Metric("ik.travel_over_best", float(np.median(total)), "x", None, "lower", f"best of {RANDOM_STARTS} starts"),
        Metric("ik.largest_turn_over_best", float(np.median(largest)), "x", None, "lower"),
    ]


def _measure_narrowed(chain: Chain) -> list[Metric]:
    """Measure the IK success rate with narrowed joint ranges.

    The ranges have 60 % and 35 % of their size.
    """
    metrics = []
    for fraction in (0.6, 0.35):
        narrow = _with_ranges(chain, fraction)
        goals = draw_targets(default_rng(8), narrow, TARGET_COUNT)
        success = _success_rate(narrow, narrow.rest, goals)
        metrics.append(Metric(f"ik.success_ranges_{round(100 * fraction)}", success, "share", 0.999, "higher"))
    return metrics


def _with_ranges(chain: Chain, fraction: float) -> Chain:
    joints = []
    for joint in chain.joints:
        hinges = []
        for hinge in joint.hinges:
            middle, half = (hinge.upper + hinge.lower) / 2, fraction * (hinge.upper - hinge.lower) / 2
            rest = float(np.clip(hinge.rest, middle - half, middle + half))
            hinges.append(replace(hinge, lower=middle - half, upper=middle + half, rest=rest))
        joints.append(replace(joint, hinges=tuple(hinges)))
    return replace(chain, joints=tuple(joints))


def _track_second_lap(chain: Chain, rate: int) -> Floats:
    """Return joint angles (steps, k) [rad] of a closed path's second lap."""
    tracker = Tracker(chain, period=1 / rate)
    steps = round(LAP_DURATION * rate)
    rows = [tracker.step(ellipse(2 * np.pi * (step % steps) / steps)) for step in range(2 * steps)]
    return sealed(rows[steps:])


def _compare_rates(chain: Chain) -> list[Metric]:
    """Compare joint angles of a closed path tracked at `TRACKING_RATES`.

    The metric is the largest difference on the second lap / the largest range of a joint.
    """
    slow, *others = (_track_second_lap(chain, rate)[:: rate // TRACKING_RATES[0]] for rate in TRACKING_RATES)
    difference = max(float(np.abs(lap - slow).max()) for lap in others) / float(np.ptp(slow, axis=0).max())
    return [Metric("ik.tracking_rates_differ", difference, "share", 0.01, "lower", "50, 200 and 1000 Hz")]


def _measure_swivel(chain: Chain) -> list[Metric]:
    """Measure spread and largest step of the elbow's swivel on a path.

    It is the second lap of a closed hand path at 200 Hz.
    """
    swivels = np.unwrap([angle for row in _track_second_lap(chain, 200) if (angle := swivel(chain, row)) is not None])
    return [
        Metric("ik.swivel_spread", float(np.std(swivels)), "rad", None, "lower", "standard deviation over a lap"),
        Metric("ik.swivel_step", float(np.abs(np.diff(swivels)).max()), "rad", None, "lower", "largest, at 200 Hz"),
    ]


def draw(path: Path) -> Path:
    """Plot IK errors, times, travel and joint angles on a closed path."""
    chain = Robot.load().arms["l"]
    misses, seconds, travel = _solve_targets(chain)
    with picture(path, 11.0, 6.4) as drawn:
        axes = drawn.subplots(2, 2)
        _draw_distribution(
            axes[0, 0], 1000 * misses + ERROR_FLOOR, "miss of the hand [mm]", "P1: goal 0.1 mm", goal=0.1
        )
        _draw_distribution(axes[0, 1], 1e6 * seconds, "time of one solve from Python [us]", "P1")
        _draw_distribution(axes[1, 0], travel, "travel from rest, sum over joints [rad]", "P3", logarithmic=False)
        _draw_laps(axes[1, 1], chain)
    return path


def _solve_targets(chain: Chain) -> tuple[Floats, Floats, Floats]:
    """Return IK errors [m], times [s] and joint travels [rad] per target."""
    rows = []
    for target in draw_targets(default_rng(1), chain, DRAWN_TARGETS):
        began = perf_counter()
        angles = solve(chain, Reach(target), start=chain.rest).angles
        duration = perf_counter() - began
        rows.append((np.linalg.norm(chain.hand(angles) - target), duration, np.abs(angles - chain.rest).sum()))
    misses, seconds, travel = np.array(rows).T
    return misses, seconds, travel


def _draw_distribution(
    axes: Axes, values: Floats, label: str, title: str, *, goal: float | None = None, logarithmic: bool = True
) -> None:
    axes.plot(np.sort(values), np.arange(1, len(values) + 1) / len(values), color=MAIN_COLOUR)
    if logarithmic:
        axes.set_xscale("log")
    if goal is not None:
        axes.axvline(goal, color=CONTRAST_COLOUR, linewidth=0.8)
    label_axes(axes, label, "fraction of targets", title=title)
    axes.grid(alpha=0.3)


def _draw_laps(axes: Axes, chain: Chain) -> None:
    steps = round(LAP_DURATION * TRACKING_RATE)
    tracker = Tracker(chain, period=1 / TRACKING_RATE)
    ours = np.array([tracker.step(ellipse(2 * np.pi * step / steps)) for step in range(2 * steps)])
    plain = np.concatenate(damped_least_squares(chain, ellipse, steps, 2))
    times = np.arange(2 * steps) / TRACKING_RATE
    for hinge in range(1, 4):
        axes.plot(
            times, np.degrees(plain[:, hinge]), color=CONTRAST_COLOUR, linewidth=0.8, label="damped least squares"
        )
        axes.plot(times, np.degrees(ours[:, hinge]), color=MAIN_COLOUR, linewidth=1.2, label="tracker")
    axes.axvline(LAP_DURATION, color=INK_COLOUR, linewidth=0.5)
    axes.legend(*(entries[:2] for entries in axes.get_legend_handles_labels()), fontsize=LABEL_SIZE, frameon=False)
    title = "P4, P5: the second lap repeats the first"
    label_axes(axes, "time on the ellipse, two laps [s]", "shoulder joints [deg]", title=title)
    axes.grid(alpha=0.3)

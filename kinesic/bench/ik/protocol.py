"""The rest of the reach protocol: other starts, travel, narrow ranges, paths at three rates, the elbow's swivel."""

from dataclasses import replace

import numpy as np
from numpy.random import default_rng

from kinesic.bench.figure import Figure
from kinesic.bench.ik.arms import targets
from kinesic.bench.ik.tracking import LAP, ellipse
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


def bench() -> list[Figure]:
    """P2, P3, P4, P5 and P8 on upper22's left arm."""
    chain = Robot.load().arms["l"]
    return [*_starts(chain), *_travel(chain), *_narrowed(chain), *_rates(chain), *_swivel(chain)]


def _share(chain: Chain, start: Floats, asked: Floats) -> float:
    found = (solve(chain, Reach(target), start=start) for target in asked)
    return float(np.mean([solution.residual < TENTH_MM for solution in found]))


def _starts(chain: Chain) -> list[Figure]:
    """P2: the straight arm, the arm held out to the side, and the corners of the ranges."""
    asked = targets(default_rng(2), chain, TARGETS[KERNEL])
    out = np.zeros(len(chain.rest))
    out[2] = np.pi / 2
    starts = {"straight": np.zeros_like(out), "aside": out, "lower_corner": chain.lower, "upper_corner": chain.upper}
    return [
        Figure(f"ik.success_from_{name}", _share(chain, start, asked), "share", 0.9999, "higher")
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
        asked = targets(default_rng(8), narrow, TARGETS[KERNEL])
        met = _share(narrow, narrow.rest, asked)
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

"""Merges blocks into a motion, or puts them in its place, at random moments: how soon, and what it then exceeds."""

import random
from dataclasses import dataclass
from statistics import median
from time import process_time

import numpy as np

from kinesic.bench.blocks import passage_text
from kinesic.bench.figure import Figure
from kinesic.bml.parse import parse
from kinesic.controller.perform import set_up
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import Trajectory
from kinesic.motion.transition import knot_at
from kinesic.planning.clearance import LEAST_RESERVE, scan_clearance
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.realizer.merge import merge, replace_motion

CUTS = 200
ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
SMALL = ('<head id="h" lexeme="NOD"/>', '<gesture id="g" lexeme="beat" mode="RIGHT_HAND"/>')
LARGE = (
    *SMALL,
    '<gaze id="z" target="right" start="0" end="1.5"/>',
    '<pointing id="p" target="left" mode="LEFT_HAND"/>',
    '<gesture id="o" lexeme="offer" mode="BOTH_HANDS"/><head id="h" lexeme="SHAKE" start="o:stroke"/>',
)


@dataclass(frozen=True)
class MergeCut:
    """One moment at which a block took the place of a motion."""

    time: float  # [s] performance time
    ratio: float  # largest share of any limit at 1 kHz, from the cut on
    step: float  # [rad] of control points that were in force at the cut
    delay: float  # [s] by which the block came later
    dropped: int  # behaviours left out
    clearance: float  # [m] over what is asked for


def bench() -> list[Figure]:
    """Times a nod and a beat over the passage, and replaces the passage in the midst of everything."""
    known = set_up()
    found = replace_at_random(known, CUTS)
    return [
        Figure("bml.live.merged", 1000 * median(_merging(known)), "ms", 15.0, "lower"),
        Figure("bml.live.replaced_ratio", max(cut.ratio for cut in found), "of limit", 1.001, "lower"),
        Figure("bml.live.replaced_step", max(cut.step for cut in found), "rad", 1e-8, "lower"),
        Figure("bml.live.replaced_clearance", min(cut.clearance for cut in found), "m", 0.0, "higher"),
        Figure("bml.live.replaced_delay", max(cut.delay for cut in found), "s", None, "lower"),
        Figure("bml.live.replaced_dropped", float(sum(cut.dropped for cut in found)), "count", 0.0, "lower"),
    ]


def replace_at_random(known: Setup, count: int, *, seed: int = 0) -> list[MergeCut]:
    """Replaces the passage, planned well, at random moments by blocks of all kinds.

    Args:
        known: of planning.
        count: of the moments.
        seed: of their choice.
    """
    chance, running = random.Random(seed), plan_block(parse(passage_text(0)), known).trajectory
    coming = [plan_block(parse(ROOT.format("b", text)), known) for text in LARGE]
    found = []
    for _ in range(count):
        time = chance.uniform(0.0, running.duration)
        over = replace_motion(running, time, chance.choice(coming))
        knot = knot_at(time)
        left = Trajectory(over.trajectory.controls[knot:], 0.0)
        largest = max(float(peak.ratios.max()) for peak in check_limits(left, known.limits).shares.values())
        step = np.abs(over.trajectory.controls[: knot + 3] - running.controls[: knot + 3]).max()
        least = known.robot.least_clearance + LEAST_RESERVE
        near = float(scan_clearance(left, known.distances)[1].distances.min()) - least
        found.append(MergeCut(time, largest, float(step), over.zero - time, len(over.dropped), near))
    return found


def _merging(known: Setup) -> list[float]:
    """[s] of one core that a nod or a beat takes to be laid over the last second of the passage."""
    running = plan_quickly(parse(passage_text(0)), known).trajectory
    small = [plan_quickly(parse(ROOT.format("b", text)), known) for text in SMALL]
    seconds = []
    for k in range(CUTS // 10):
        time = running.duration - 1.0 + 0.04 * (k % 20)
        began = process_time()
        merge(running, time, small[k % len(small)], begin=time)
        seconds.append(process_time() - began)
    return seconds

"""Benchmark of block merging and motion replacement during a performance.

It measures the merging time and limit violations at random replacement times.
"""

import random
from dataclasses import dataclass
from statistics import median
from time import process_time

import numpy as np

from kinesic.bench.blocks import write_passage
from kinesic.bench.metric import Metric
from kinesic.bml.parse import parse
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import Trajectory
from kinesic.motion.transition import knot_at
from kinesic.planning.clearance import MIN_LAG_RESERVE, scan_clearance
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.realizer.merge import merge, replace_motion
from kinesic.session.setup import set_up

REPLACEMENT_COUNT = 200  # number of motion replacements at random times
BLOCK_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
SMALL_BLOCKS = ('<head id="h" lexeme="NOD"/>', '<gesture id="g" lexeme="beat" mode="RIGHT_HAND"/>')
LARGE_BLOCKS = (
    *SMALL_BLOCKS,
    '<gaze id="z" target="right" start="0" end="1.5"/>',
    '<pointing id="p" target="left" mode="LEFT_HAND"/>',
    '<gesture id="o" lexeme="offer" mode="BOTH_HANDS"/><head id="h" lexeme="SHAKE" start="o:stroke"/>',
)


@dataclass(frozen=True)
class MergeCut:
    """Limit ratio, clearance and delay after one replacement of a running motion."""

    time: float  # [s] performance time
    ratio: float  # largest value / limit at 1 kHz after the cut
    step: float  # [rad] largest change of control points already in force at the cut
    delay: float  # [s] delay of the block
    dropped: int  # number of dropped behaviours
    clearance: float  # [m] clearance minus the required clearance


def bench() -> list[Metric]:
    """Measure the merging time of blocks, and replacements of a running motion."""
    setup = set_up()
    cuts = replace_at_random(setup, REPLACEMENT_COUNT)
    return [
        Metric("bml.live.merged", 1000 * median(_time_merging(setup)), "ms", 15.0, "lower"),
        Metric("bml.live.replaced_ratio", max(cut.ratio for cut in cuts), "of limit", 1.001, "lower"),
        Metric("bml.live.replaced_step", max(cut.step for cut in cuts), "rad", 1e-8, "lower"),
        Metric("bml.live.replaced_clearance", min(cut.clearance for cut in cuts), "m", 0.0, "higher"),
        Metric("bml.live.replaced_delay", max(cut.delay for cut in cuts), "s", None, "lower"),
        Metric("bml.live.replaced_dropped", float(sum(cut.dropped for cut in cuts)), "count", 0.0, "lower"),
    ]


def replace_at_random(setup: Setup, count: int, *, seed: int = 0) -> list[MergeCut]:
    """Measure replacements of the passage's motion by blocks at random times.

    Args:
        setup: robot, style and options.
        count: number of replacements.
        seed: seed of random times and blocks.
    """
    rng, running = random.Random(seed), plan_block(parse(write_passage(0)), setup).trajectory
    plans = [plan_block(parse(BLOCK_TEMPLATE.format("b", text)), setup) for text in LARGE_BLOCKS]
    cuts = []
    for _ in range(count):
        time = rng.uniform(0.0, running.duration)
        replacement = replace_motion(running, time, rng.choice(plans))
        knot = knot_at(time)
        remaining = Trajectory(replacement.trajectory.controls[knot:], 0.0)
        largest = max(float(peak.ratios.max()) for peak in check_limits(remaining, setup.limits).by_quantity.values())
        step = np.abs(replacement.trajectory.controls[: knot + 3] - running.controls[: knot + 3]).max()
        min_clearance = setup.robot.min_clearance + MIN_LAG_RESERVE
        clearance = float(scan_clearance(remaining, setup.distances)[1].distances.min()) - min_clearance
        cuts.append(MergeCut(time, largest, float(step), replacement.zero - time, len(replacement.dropped), clearance))
    return cuts


def _time_merging(setup: Setup) -> list[float]:
    """Measure CPU times [s] of merging small blocks into a motion."""
    running = plan_quickly(parse(write_passage(0)), setup).trajectory
    small = [plan_quickly(parse(BLOCK_TEMPLATE.format("b", text)), setup) for text in SMALL_BLOCKS]
    seconds = []
    for k in range(REPLACEMENT_COUNT // 10):
        time = running.duration - 1.0 + 0.04 * (k % 20)
        began = process_time()
        merge(running, time, small[k % len(small)], begin=time)
        seconds.append(process_time() - began)
    return seconds

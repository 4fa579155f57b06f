"""Measures how soon a block begins after its text is in memory, and how soon a better plan takes over."""

from statistics import median
from time import perf_counter

import numpy as np

from kinesic.bench.blocks import passage_text
from kinesic.bench.figure import Figure
from kinesic.bml.parse import parse
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.perform import set_up
from kinesic.controller.play import command_times, commands
from kinesic.motion.trajectory import stay
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.realizer.merge import merge
from kinesic.realizer.replan import replan

REPETITIONS = 40
OVER = 0.2  # [s] of the opening that is played before the better plan takes over


def bench() -> list[Figure]:
    """Times the passage from its text to the first command, and the way over into the better plan."""
    known = set_up()
    _first(passage_text(0), known)
    seconds = [_first(passage_text(repetition), known) for repetition in range(1, REPETITIONS + 1)]
    over = []
    for repetition in range(1, 6):
        block = parse(passage_text(repetition))
        better = plan_block(block, known)
        playing = merge(stay(known.robot.skeleton.rest), 0.0, plan_quickly(block, known), begin=0.0)
        began = perf_counter()
        found = replan(playing.trajectory, OVER, playing, better)
        over.append(1000 * (perf_counter() - began) if found else np.inf)
    return [
        Figure("plan.first_command_p95", 1000 * float(np.percentile(seconds, 95)), "ms", 100.0, "lower"),
        Figure("plan.first_command_median", 1000 * median(seconds), "ms", None, "lower"),
        Figure("plan.taken_over", median(over), "ms", None, "lower"),
    ]


def _first(text: str, known: Setup) -> float:
    """[s] from a text to its first command."""
    began = perf_counter()
    planned = plan_quickly(parse(text), known)
    times = command_times(planned.duration)
    setpoints = FeedForward(known.robot, known.dynamics).lead(planned.trajectory, times[:1])
    next(iter(commands(planned.trajectory, times[:1], setpoints)))
    return perf_counter() - began

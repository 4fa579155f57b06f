"""Benchmark of first-command delay and of switching from quick to better plan."""

from statistics import median
from time import perf_counter

import numpy as np

from kinesic.bench.blocks import write_passage
from kinesic.bench.metric import Metric
from kinesic.bml.parse import parse
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.play import commands
from kinesic.motion.trajectory import stay
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.realizer.merge import merge
from kinesic.realizer.replan import replan
from kinesic.session.setup import set_up

COMMAND_REPETITIONS = 40  # number of timed delays of the first command
SWITCH_TIME = 0.2  # [s] time for which the quick plan plays before the better plan takes over


def bench() -> list[Metric]:
    """Measure first-command delay and the time to switch to a better plan."""
    setup = set_up()
    _time_first_command(write_passage(0), setup)
    seconds = [
        _time_first_command(write_passage(repetition), setup) for repetition in range(1, COMMAND_REPETITIONS + 1)
    ]
    switch_times = []
    for repetition in range(1, 6):
        block = parse(write_passage(repetition))
        better = plan_block(block, setup)
        playing = merge(stay(setup.robot.skeleton.rest), 0.0, plan_quickly(block, setup), begin=0.0)
        began = perf_counter()
        replanned = replan(playing.trajectory, SWITCH_TIME, playing, better)
        switch_times.append(1000 * (perf_counter() - began) if replanned else np.inf)
    return [
        Metric("plan.first_command_p95", 1000 * float(np.percentile(seconds, 95)), "ms", 100.0, "lower"),
        Metric("plan.first_command_median", 1000 * median(seconds), "ms", None, "lower"),
        Metric("plan.taken_over", median(switch_times), "ms", None, "lower"),
    ]


def _time_first_command(text: str, setup: Setup) -> float:
    """Return the time [s] from a text to its first command."""
    began = perf_counter()
    planned = plan_quickly(parse(text), setup)
    times = planned.command_times
    setpoints = FeedForward(setup.robot, setup.dynamics).compute_setpoints(planned.trajectory, times[:1])
    next(iter(commands(planned.trajectory, times[:1], setpoints)))
    return perf_counter() - began

"""Adds secondary motion to a certified motion, as far as limits, torques and clearance allow it."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import chain
from zlib import crc32

import numpy as np

from kinesic.bml.block import Pointing, Timeline
from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import SIDES
from kinesic.body.utterance import Utterance
from kinesic.motion.condition import Conditioned
from kinesic.motion.trajectory import FEWEST, Trajectory
from kinesic.planning.certify import overloaded_times
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.secondary.breath import breaths
from kinesic.planning.secondary.drift import drifts
from kinesic.planning.secondary.swells import Swell, add_swells, exceeded
from kinesic.planning.secondary.talking import talking
from kinesic.planning.setup import Setup

LESS = 0.4  # of a swell that hinders, before it is left out
NEARER = 1e-6  # [m] by which clearance may shrink where it is scarce
LIVELIEST = 1.5  # times a style's share of the body


def add_secondary_motion(
    motion: Conditioned,
    times: Floats,
    clearance: Clearance,
    timeline: Timeline,
    utterances: Mapping[str, Utterance],
    setup: Setup,
) -> tuple[Conditioned, Floats, Clearance]:
    """Lets the body breathe, stray from poses that it holds, and move its head as it speaks.

    Keys stay where they are, and none comes at another time. What brings a hinge beyond a limit, or a segment too near
    to another one, becomes less, and is left out where that is not enough: first what arms do, then the rest.

    Args:
        motion: certified and clear.
        times: (m,) [s] performance time.
        clearance: of the motion, at these times.
        timeline: of the block.
        utterances: of its speeches, by their ids.
        setup: robot, limits, and how lively it is.

    Returns:
        The motion, and times (k,) [s] with its clearance.
    """
    swells = _swells(motion.trajectory, timeline, utterances, setup)
    if not swells:
        return motion, times, clearance
    alone = motion.trajectory
    amounts, away = np.ones(len(swells)), np.array([swell.away != 0.0 for swell in swells])
    of_arms = away[:, [joint for side in SIDES for joint in setup.robot.arm(side).joints]].any(axis=1)
    laid = add_swells(alone, zip(swells, amounts.tolist(), strict=True))
    times, found = scan_clearance(laid, setup.distances)
    spans = np.array([swell.spans(times) for swell in swells])
    bad = _hindered(alone, laid, times, (found, clearance), setup)
    while np.any(met := (amounts > 0.0) & np.any(spans & (away @ bad.T), axis=1)):
        less = met & of_arms if np.any(met & of_arms) else met
        amounts = np.where(less, np.where(amounts == 1.0, LESS, 0.0), amounts)
        laid = add_swells(alone, zip(swells, amounts.tolist(), strict=True))
        changed = np.any(spans[less], axis=0)
        found = _measure_again(found, changed, laid.sample(times[changed])[0], setup)
        bad = np.array(bad)
        bad[changed] = _hindered(alone, laid, times, (found, clearance), setup, changed)[changed]
    return replace(motion, trajectory=laid), times, found


def _measure_again(found: Clearance, changed: Flags, angles: Floats, setup: Setup) -> Clearance:
    """The clearance where it changed at some times, with angles (k, n) [rad] at them."""
    now = setup.distances.clearance(angles)
    distances, pairs = np.array(found.distances), list(found.pairs)
    distances[changed] = now.distances
    for k, pair in zip(np.flatnonzero(changed).tolist(), now.pairs, strict=True):
        pairs[k] = pair
    return Clearance(sealed(distances), pairs)


def _swells(
    motion: Trajectory, timeline: Timeline, utterances: Mapping[str, Utterance], setup: Setup
) -> tuple[Swell, ...]:
    """All that a block leaves room for; nothing while an arm points at something."""
    idling, robot, zero = setup.idling, setup.robot, motion.zero
    if idling.amount == 0.0:
        return ()
    chance = np.random.default_rng((idling.seed, crc32(timeline.block.id.encode())))
    part = idling.amount * min(setup.style.whole_body, LIVELIEST)
    whole = max(zero + timeline.start, motion.start), max(zero + timeline.end, motion.end)
    found = chain(
        breaths(whole, idling.amount, robot, chance),
        drifts(motion, idling.amount, robot, chance),
        (each.later(zero) for each in talking(timeline, utterances, part, robot, chance)),
    )
    aiming = [
        (zero + timed.times["start"], zero + timed.times["end"])
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Pointing)
    ]
    return tuple(swell for swell in found if not any(begin < swell.end and swell.begin < end for begin, end in aiming))


def _hindered(
    alone: Trajectory,
    laid: Trajectory,
    times: Floats,
    clearances: tuple[Clearance, Clearance],
    setup: Setup,
    looked_at: Flags | None = None,
) -> Flags:
    """Finds at which times (m,) swells must not move which hinges (n,) as they do, though the motion alone may.

    A limit is that of one hinge; distances and torques are everybody's.
    """
    now, before = clearances
    chosen = np.ones(len(times), dtype=np.bool_) if looked_at is None else looked_at
    distances = before.distances[np.minimum(np.arange(len(times)), len(before.distances) - 1)]
    least = np.minimum(setup.robot.least_clearance + LAG_RESERVE, distances - NEARER)
    found = exceeded(alone, laid, setup.limits)[np.minimum(np.arange(len(times)), len(laid.controls) - FEWEST)]
    found[now.distances < least] = True
    found[np.isin(times, overloaded_times(alone, laid, times[chosen], setup))] = True
    return found

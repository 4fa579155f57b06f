"""A hand does one work after the other: it leaves a hold or a retraction for what comes next (co-articulation)."""

from collections.abc import Sequence
from math import ceil, floor
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.trajectory import STEP
from kinesic.motion.transition import EARLY, LEAST, SAME, crossed
from kinesic.realizer.busy import Busy, Role
from kinesic.realizer.work import Failed, Work

AGAIN = 1.5  # times as long, when a way back to rest is too short
LONGEST = 400  # pieces of a way back to rest
LEAST_BACK = 30  # pieces


def handed(work: Work, role: Role, hinge: int, limits: Limits) -> Floats | Failed:
    """One hinge of an arm, through all that its hand has to do.

    Args:
        work: what is laid over what.
        role: of the hand.
        hinge: of its arm.
        limits: of all hinges.

    Returns:
        (k + 3,) [rad] control points, maybe of more pieces than what is laid over what; the behaviour of the block for
        which there is no time between two works.
    """
    sources = {"base": work.base[:, hinge], "coming": work.coming[:, hinge]}
    column, source, left = sources["base"], "base", float(work.cut * STEP)
    done = None
    for stop, of in _stops(work, role):
        if stop.ready < work.cut * STEP - EARLY:
            column, source = sources[of], of  # it is there already
        elif of != source or (done and of == "coming" and _between(work.dropped, role, done, stop)):
            way = _led(column, sources[of], left, stop, limits, hinge)
            if way is None:
                name = stop.behaviour if of == "coming" or done is None else done.behaviour
                return Failed(name, "its hand has not the time to come from one work to the next")
            column, source = way, of
        left, done = max(left, stop.relax), stop
    if source == "base" or done is None:
        return column
    return _home(column, sources, done, work, role, limits, hinge)


def _stops(work: Work, role: Role) -> list[tuple[Busy, Literal["base", "coming"]]]:
    """What a hand has to do, in order; empty where the block asks nothing of it."""
    own: list[tuple[Busy, Literal["base", "coming"]]] = [(b, "coming") for b in work.performed if role in b.roles]
    if not own:
        return []
    return sorted([*own, *((b, "base") for b in work.held if role in b.roles)], key=lambda stop: stop[0].ready)


def _between(dropped: Sequence[Busy], role: Role, before: Busy, after: Busy) -> bool:
    return any(role in gone.roles and before.ready <= gone.ready <= after.ready for gone in dropped)


def _led(own: Floats, after: Floats, left: float, stop: Busy, limits: Limits, hinge: int) -> Floats | None:
    """From one work to the next: where both are one, else when the next begins, or as soon as the one gives way."""
    land, soonest = floor(stop.ready / STEP + EARLY), ceil(left / STEP - EARLY)
    apart = np.abs(own[soonest : land + LEAST] - after[soonest : land + LEAST]) > SAME
    together = np.flatnonzero(~(apart[:-2] | apart[1:-1] | apart[2:]))
    leaves = (
        [soonest + int(together[-1])] if len(together) else [max(soonest, floor(stop.begin / STEP + EARLY)), soonest]
    )
    ways = (crossed(own, after, leave, land, limits, hinge) for leave in leaves)
    return next((way for way in ways if way is not None), None)


def _home(
    column: Floats, sources: dict[str, Floats], done: Busy, work: Work, role: Role, limits: Limits, hinge: int
) -> Floats | Failed:
    """After its last work the hand rests as it did before, unless the block ends elsewhere."""
    base, coming = sources["base"], sources["coming"]
    cleanly = not any(role in gone.roles and gone.ready >= done.ready for gone in work.dropped)
    other_rest = abs(coming[-1] - coming[0]) > SAME
    if cleanly and (other_rest or abs(base[-1] - coming[-1]) <= SAME):
        return column
    rest = np.full(len(base), base[-1])
    leave = ceil(done.relax / STEP - EARLY)
    pieces = max(LEAST_BACK, ceil((done.end - done.relax) / STEP))
    while pieces <= LONGEST:
        short = max(0, leave + pieces + LEAST - len(column))
        own, after = (np.pad(each, (0, short), mode="edge") for each in (column, rest))
        way = crossed(own, after, leave, leave + pieces, limits, hinge)
        if way is not None:
            return way
        pieces = ceil(AGAIN * pieces)
    return Failed(done.behaviour, "its hand has no way back to rest within its limits")

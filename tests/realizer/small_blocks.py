"""Blocks, occupancies and motions made by hand, without planning."""

from types import SimpleNamespace

import numpy as np

from kinesic.bml.block import Timeline
from kinesic.bml.composition import BlockState
from kinesic.bml.parse import parse
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.syncs import SyncTime
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import Occupancy
from kinesic.realizer.request import TimedRequest
from kinesic.realizer.running_block import PreparedBlock, RunningBlock

from .conftest import BML_NAMESPACES

HINGE_COUNT = 22


def small_motion(count: int = 400, *, angle: float = 0.0, start: float = 0.0) -> Trajectory:
    """Return a motion that keeps one angle [rad] in all hinges."""
    return Trajectory(np.full((count, HINGE_COUNT), angle), 0.25, start)


def use(id="g", *roles, begin=1.0, ready=2.0, relax=4.0, end=5.0, offset=None, hinges=()) -> Occupancy:
    """Return an occupancy with times [s] and moved hinges."""
    moved = np.isin(np.arange(HINGE_COUNT), hinges)
    return Occupancy(id, frozenset(roles), moved, begin, ready, relax, end, offset)


def small_block(
    id,
    times=None,
    *,
    inside="",
    attributes="",
    state=BlockState.IN_EXEC,
    zero=0.0,
    motion=None,
    occupancy=(),
    moves=True,
    utterances=None,
    notices=(),
    quick_notices=(),
    is_provisional=False,
    waits=None,
    run=0,
    sender=5,
    **request,
) -> RunningBlock:
    """Return a block with block times [s] by behaviour and sync point."""
    times = times or {}
    block = parse(f'<bml {BML_NAMESPACES} id="{id}" {attributes}>{inside}</bml>')
    plan = SimpleNamespace(
        timeline=SimpleNamespace(block=block),
        syncs=tuple(SyncTime(name, sync, 0.0, time) for name, at in times.items() for sync, time in at.items()),
        utterances=utterances or {},
        postures=SimpleNamespace(postures=(0, 1) if moves else (0,)),
        notices=notices,
        keyframes=SimpleNamespace(notices=quick_notices, frames=()),
    )
    known = TimedRequest(sender, block, utterances or {}, Timeline(block, ()), zero, **request)
    merged = None if motion is None else MergedMotion(motion, zero, motion, tuple(occupancy), (), (), ())
    return RunningBlock(PreparedBlock(known, plan, is_provisional), state, zero, times, waits or {}, merged, run=run)

"""Refines the plans of blocks that play, in a process of its own, so that the planner stays free for new requests."""

import io
import os
import pickle
from collections.abc import Callable
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection

from kinesic.bml.block import BmlError
from kinesic.expressivity.style.style import Style
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import prepare_block
from kinesic.realizer.request import TimedRequest
from kinesic.serve.renewal import renew_setup

NICE = 5  # behind loop and planner
SETUP = "setup"  # stands for it where a plan is sent: either side has its own


@dataclass(frozen=True, eq=False)
class RefinementJob:
    """A job for the refiner: plan a block better, or in another manner."""

    request: TimedRequest
    style: Style  # of those that do not say theirs
    renewals: int = 0  # how often gestures were read anew so far


@dataclass(frozen=True, eq=False)
class RefinedPlan:
    """The answer of the refiner: the new plan of a block."""

    block: str  # its id
    plan: Plan | None  # None: it cannot be performed so


class _Pickler(pickle.Pickler):
    def persistent_id(self, thing: object) -> str | None:
        return SETUP if isinstance(thing, Setup) else None


class _Unpickler(pickle.Unpickler):
    def __init__(self, data: bytes, setup: Setup) -> None:
        super().__init__(io.BytesIO(data))
        self._setup = setup

    def persistent_load(self, name: object) -> Setup:
        if name != SETUP:
            raise pickle.UnpicklingError(f"{name!r} stands for nothing; {SETUP!r} does")
        return self._setup


def pack(message: RefinementJob | RefinedPlan) -> bytes:
    """Pickles a job or its result without the setup."""
    stream = io.BytesIO()
    _Pickler(stream, pickle.HIGHEST_PROTOCOL).dump(message)
    return stream.getvalue()


def unpack(data: bytes, setup: Setup) -> RefinementJob | RefinedPlan:
    """Unpickles a job or its result with the setup of this side."""
    found = _Unpickler(data, setup).load()
    if not isinstance(found, RefinementJob | RefinedPlan):
        raise pickle.UnpicklingError(
            f"a {type(found).__name__} came, only {RefinementJob.__name__} and {RefinedPlan.__name__} do"
        )
    return found


def run_refiner(make_setup: Callable[[], Setup], planner: Connection) -> None:
    """Does the jobs that the planner sends, one after the other, until the planner has ended."""
    try:
        os.nice(NICE)
        setup, renewals = make_setup(), 0
        while True:
            job = unpack(planner.recv_bytes(), setup)
            if isinstance(job, RefinementJob):
                if job.renewals != renewals:
                    setup, renewals = renew_setup(make_setup, setup), job.renewals
                styled = setup if job.style == setup.style else replace(setup, style=job.style)
                planner.send_bytes(pack(_refine(job.request, styled)))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def _refine(request: TimedRequest, setup: Setup) -> RefinedPlan:
    try:
        return RefinedPlan(request.block.id, prepare_block(request, setup).plan)
    except BmlError:
        return RefinedPlan(request.block.id, None)

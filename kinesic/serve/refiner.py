"""The process that plans again, at leisure, what has begun already: the planner is free for what comes meanwhile."""

import io
import os
import pickle
import signal
from collections.abc import Callable
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection

from kinesic.bml.block import BmlError
from kinesic.expressivity.style.style import Style
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import ready
from kinesic.realizer.request import TimedRequest

NICE = 5  # behind loop and planner
FACTS = "facts"  # stands for them where a plan is sent: either side has its own


@dataclass(frozen=True, eq=False)
class RefinementJob:
    """To the improver: a block that could be planned better, or in another manner."""

    asked: TimedRequest
    style: Style  # of those that do not say theirs


@dataclass(frozen=True, eq=False)
class RefinedPlan:
    """From the improver."""

    block: str  # its id
    plan: Plan | None  # None: it cannot be performed so


class _Pickler(pickle.Pickler):
    def persistent_id(self, thing: object) -> str | None:
        return FACTS if isinstance(thing, Setup) else None


class _Unpickler(pickle.Unpickler):
    def __init__(self, data: bytes, facts: Setup) -> None:
        super().__init__(io.BytesIO(data))
        self._facts = facts

    def persistent_load(self, name: object) -> Setup:
        if name != FACTS:
            raise pickle.UnpicklingError(f"{name!r} stands for nothing; {FACTS!r} does")
        return self._facts


def pack(thing: RefinementJob | RefinedPlan) -> bytes:
    """As bytes, without the facts."""
    stream = io.BytesIO()
    _Pickler(stream, pickle.HIGHEST_PROTOCOL).dump(thing)
    return stream.getvalue()


def unpack(data: bytes, facts: Setup) -> RefinementJob | RefinedPlan:
    """From bytes, with the facts of this side."""
    found = _Unpickler(data, facts).load()
    if not isinstance(found, RefinementJob | RefinedPlan):
        raise pickle.UnpicklingError(
            f"a {type(found).__name__} came, only {RefinementJob.__name__} and {RefinedPlan.__name__} do"
        )
    return found


def run_refiner(facts_of: Callable[[], Setup], planner: Connection) -> None:
    """Plans whatever the planner sends, one after the other, until it is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        os.nice(NICE)
        facts = facts_of()
        while True:
            leisure = unpack(planner.recv_bytes(), facts)
            if isinstance(leisure, RefinementJob):
                known = facts if leisure.style == facts.style else replace(facts, style=leisure.style)
                planner.send_bytes(pack(_better(leisure.asked, known)))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def _better(asked: TimedRequest, facts: Setup) -> RefinedPlan:
    try:
        return RefinedPlan(asked.block.id, ready(asked, facts).plan)
    except BmlError:
        return RefinedPlan(asked.block.id, None)

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
from kinesic.realizer.request import Asked

NICE = 5  # behind loop and planner
FACTS = "facts"  # stands for them where a plan is sent: either side has its own


@dataclass(frozen=True, eq=False)
class Leisure:
    """To the improver: a block that could be planned better, or in another manner."""

    asked: Asked
    style: Style  # of those that do not say theirs


@dataclass(frozen=True, eq=False)
class Better:
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


def packed(thing: Leisure | Better) -> bytes:
    """As bytes, without the facts."""
    stream = io.BytesIO()
    _Pickler(stream, pickle.HIGHEST_PROTOCOL).dump(thing)
    return stream.getvalue()


def unpacked(data: bytes, facts: Setup) -> Leisure | Better:
    """From bytes, with the facts of this side."""
    found = _Unpickler(data, facts).load()
    if not isinstance(found, Leisure | Better):
        raise pickle.UnpicklingError(f"a {type(found).__name__} came, only {Leisure.__name__} and {Better.__name__} do")
    return found


def run_refiner(facts_of: Callable[[], Setup], planner: Connection) -> None:
    """Plans whatever the planner sends, one after the other, until it is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        os.nice(NICE)
        facts = facts_of()
        while True:
            leisure = unpacked(planner.recv_bytes(), facts)
            if isinstance(leisure, Leisure):
                known = facts if leisure.style == facts.style else replace(facts, style=leisure.style)
                planner.send_bytes(packed(_better(leisure.asked, known)))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def _better(asked: Asked, facts: Setup) -> Better:
    try:
        return Better(asked.block.id, ready(asked, facts).plan)
    except BmlError:
        return Better(asked.block.id, None)

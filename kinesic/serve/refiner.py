"""Background process that replans running blocks."""

import io
import pickle
from collections.abc import Callable
from dataclasses import dataclass, replace

from kinesic.bml.block import BmlError
from kinesic.body.utterance import Script
from kinesic.child import PipeEnd
from kinesic.expressivity.style.style import Style
from kinesic.host import lower_priority
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import prepare_block
from kinesic.realizer.request import TimedRequest
from kinesic.serve.renewal import renew_setup

REFINER_NICENESS = 5  # niceness of the refiner: lower priority than loop and planner
FIRST_SCRIPT = Script("Yes.")  # spoken at the start, so that a voice loads its model and memory stays constant later
SETUP_KEY = "setup"  # placeholder for the setup in pickled messages; each process has a setup


@dataclass(frozen=True, eq=False)
class RefinementJob:
    """Request to the refiner: replan a block, possibly in another style."""

    request: TimedRequest
    style: Style  # default style of the block's behaviours
    renewals: int = 0  # lexicon reloads requested before this job


@dataclass(frozen=True, eq=False)
class RefinedPlan:
    """Result of the refiner: the new plan of a block."""

    block: str  # id of the block
    plan: Plan | None  # None: planning failed


class _Pickler(pickle.Pickler):
    def persistent_id(self, thing: object) -> str | None:
        return SETUP_KEY if isinstance(thing, Setup) else None


class _Unpickler(pickle.Unpickler):
    def __init__(self, data: bytes, setup: Setup) -> None:
        super().__init__(io.BytesIO(data))
        self._setup = setup

    def persistent_load(self, name: object) -> Setup:
        if name != SETUP_KEY:
            raise pickle.UnpicklingError(f"unknown placeholder {name!r}, expected {SETUP_KEY!r}")
        return self._setup


def pack(message: RefinementJob | RefinedPlan) -> bytes:
    """Pickle a job or its result without the setup."""
    stream = io.BytesIO()
    _Pickler(stream, pickle.HIGHEST_PROTOCOL).dump(message)
    return stream.getvalue()


def unpack(data: bytes, setup: Setup) -> RefinementJob | RefinedPlan:
    """Unpickle a job or its result with the local setup."""
    message = _Unpickler(data, setup).load()
    if not isinstance(message, RefinementJob | RefinedPlan):
        raise pickle.UnpicklingError(
            f"unexpected {type(message).__name__}, not {RefinementJob.__name__} or {RefinedPlan.__name__}"
        )
    return message


def run_refiner(make_setup: Callable[[], Setup], planner: PipeEnd) -> None:
    """Process jobs from the planner in sequence until the planner ends."""
    try:
        lower_priority(REFINER_NICENESS)
        setup, renewals = make_setup(), 0
        setup.voice.say(FIRST_SCRIPT)
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

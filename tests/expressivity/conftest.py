"""Fixtures: robot, lexicon, timelines, contexts and performed blocks."""

from collections.abc import Callable, Mapping

import pytest

from kinesic.bml.block import GESTURE_SYNCS, Action, Behaviour, Block, Place, TimedBehaviour, Timeline
from kinesic.body.dynamics import Load
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.expressivity.context import BlockContext, Context
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Style

RequestedBehaviour = tuple[str, Action, Mapping[str, float]]


@pytest.fixture(scope="session")
def robot() -> Robot:
    return Robot.load()


@pytest.fixture(scope="session")
def limits() -> Callable[[Robot], Limits]:
    """Return joint limits similar to the worst case of the default robot."""

    def of(robot: Robot) -> Limits:
        stall = robot.drives.stall
        return Limits.of(robot, Load(inertia=stall / 100, holding=0.2 * stall))

    return of


@pytest.fixture(scope="session")
def pace(robot, limits) -> Pace:
    return Pace(robot, limits(robot))


@pytest.fixture(scope="session")
def lexicon() -> Lexicon:
    return Lexicon.load()


@pytest.fixture(scope="session")
def phases() -> Callable[..., dict[str, float]]:
    """Return a function that makes the seven sync points of a gesture from times."""
    return lambda *times: dict(zip(GESTURE_SYNCS, map(float, times), strict=True))


@pytest.fixture(scope="session")
def nod_times(phases) -> dict[str, float]:
    """Return the sync points of a nod that lasts one second."""
    return phases(0.0, 0.1, 0.2, 0.5, 0.8, 0.9, 1.0)


@pytest.fixture(scope="session")
def timeline() -> Callable[..., Timeline]:
    """Return a function that builds a timeline from (id, action, times).

    Behaviours with ids in `required` are required.
    """

    def build(*asked: RequestedBehaviour, required: tuple[str, ...] = (), dialect: str = "bml-1.0") -> Timeline:
        timed = tuple(
            TimedBehaviour(Behaviour(id, type(action).__name__, action, Place(1, 1), required=id in required), times)
            for id, action, times in asked
        )
        return Timeline(Block("bml1", tuple(one.behaviour for one in timed), dialect=dialect), timed)

    return build


@pytest.fixture(scope="session")
def context(pace, lexicon) -> Callable[..., BlockContext]:
    """Return a function that builds a block context with default options."""
    usual = pace

    def of(block: Block, style: Style | None = None, *, pace: Pace = usual, **options) -> BlockContext:
        return BlockContext(block, Context(style or Style(), lexicon, pace, **options))

    return of


@pytest.fixture(scope="session")
def perform(timeline, context) -> Callable[..., KeyFrames]:
    """Return a function that creates key frames from (id, action, times)."""

    def run(*asked: RequestedBehaviour, style: Style | None = None, **options) -> KeyFrames:
        without = options.pop("without", {})
        built = timeline(*asked, **options)
        return make_keyframes(built, context(built.block, style), without=without)

    return run

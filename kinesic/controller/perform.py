"""Joins the line with the sinks: plans a document, performs it in the twin, and reports."""

import warnings
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from time import perf_counter
from typing import Literal, TypedDict, Unpack

from kinesic.bml.block import Dialect
from kinesic.bml.parse import parse
from kinesic.body.arrays import Floats
from kinesic.body.command import RATE, Measurements
from kinesic.body.robot import Robot
from kinesic.controller.feedforward import FeedForward, Terms
from kinesic.controller.observer import Observer, correct_goals
from kinesic.controller.performance import Performance, Reference
from kinesic.controller.play import command_times, commands, play_together
from kinesic.expressivity.gather import Gathering
from kinesic.expressivity.idle import OFF, Idling
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.twin import Twin
from kinesic.speech.voice import VoiceName
from kinesic.speech.voice import voice as make_voice


class _Options(TypedDict, total=False):
    style: Style | str
    lexicon: Path | None
    targets: Mapping[str, Floats] | None
    dialect: Dialect | Literal["auto"]
    gathering: Gathering
    idling: Idling
    voice: VoiceName
    pause: float


def set_up(
    robot: Robot | str | Path = "upper22",
    *,
    style: Style | str = "neutral",
    lexicon: Path | None = None,
    targets: Mapping[str, Floats] | None = None,
    dialect: Dialect | Literal["auto"] = "auto",
    gathering: Gathering = "complex",
    idling: Idling = OFF,
    voice: VoiceName = "durations",
    pause: float = 0.0,
) -> Setup:
    """Loads what planning needs, with MuJoCo's dynamics.

    The voice is the silent one unless another is asked for, so that times are the same on every machine.

    Raises:
        ConfigError: robot, style, lexicon or voice is missing or wrong.
    """
    body = robot if isinstance(robot, Robot) else Robot.load(robot)
    return Setup(
        robot=body,
        style=style if isinstance(style, Style) else Style.load(style),
        lexicon=Lexicon.load(lexicon),
        voice=make_voice(voice),
        dynamics=MujocoDynamics(body),
        distances=CapsuleDistances(body),
        targets=dict(targets or {}),
        dialect=dialect,
        gathering=gathering,
        idling=idling,
        pause=pause,
    )


def facts(robot: Robot | str | Path = "upper22", **options: Unpack[_Options]) -> Setup:
    """Does what `set_up` does. Deprecated: use `kinesic.Performer`; it goes with the next release."""
    warnings.warn("facts is deprecated: use kinesic.Performer, or set_up", DeprecationWarning, stacklevel=2)
    return set_up(robot, **options)


def plan(text: str | bytes, known: Setup | None = None, *, source: str = "<text>") -> Plan:
    """Plans a BML document; nothing moves.

    Raises:
        BmlError: the document is refused.
    """
    known = known or set_up()
    return plan_block(parse(text, source=source, dialect=known.dialect), known)


def perform(
    text: str | bytes,
    known: Setup | None = None,
    *,
    source: str = "<text>",
    twin: Factors = NOMINAL,
    feedforward: Terms = "full",
    correction: bool = True,
) -> Performance:
    """Plans a BML document and performs it in the twin.

    Raises:
        BmlError: the document is refused.
    """
    return performances(text, (twin,), known, source=source, feedforward=feedforward, correction=correction)[0]


def performances(
    text: str | bytes,
    twins: Sequence[Factors],
    known: Setup | None = None,
    *,
    source: str = "<text>",
    feedforward: Terms = "full",
    correction: bool = True,
) -> tuple[Performance, ...]:
    """Plans a BML document and performs it in several twins.

    Raises:
        BmlError: the document is refused.
    """
    known = known or set_up()
    began = perf_counter()
    block = parse(text, source=source, dialect=known.dialect)
    parsed = perf_counter() - began
    planned = plan_block(block, known)
    return dry_runs(planned, twins, feedforward=feedforward, correction=correction, parse_seconds=parsed)


def dry_run(
    planned: Plan,
    *,
    twin: Factors = NOMINAL,
    feedforward: Terms = "full",
    correction: bool = True,
    delay: float = 0.0,
) -> Performance:
    """Performs a plan in one twin: see `dry_runs`."""
    return dry_runs(planned, (twin,), feedforward=feedforward, correction=correction, delay=delay)[0]


def dry_runs(
    planned: Plan,
    twins: Sequence[Factors],
    *,
    feedforward: Terms = "full",
    correction: bool = True,
    delay: float = 0.0,
    parse_seconds: float = 0.0,
) -> tuple[Performance, ...]:
    """Performs a plan in several twins at once, tick by tick, so that they share what does not depend on them.

    Args:
        planned: what is performed.
        twins: how far each twin is from the robot's description.
        feedforward: what of the servos' model is inverted.
        correction: whether goals are corrected by what the twins measure.
        delay: [s] of the bus, as feed-forward and correction believe it to be; the twins' own is in their factors.
        parse_seconds: for the report.
    """
    known, trajectory, robot = planned.setup, planned.trajectory, planned.setup.robot
    began = perf_counter()
    times = command_times(planned.duration)
    setpoints = FeedForward(robot, known.dynamics, delay=delay, terms=feedforward).lead(trajectory, times)
    stream = tuple(commands(trajectory, times, setpoints))
    observer = _observer(known, delay, len(twins)) if correction else None

    def performed(*, touches: bool) -> list[Measurements]:
        start = trajectory.at(0.0).angles
        bodies = [Twin(robot, factors=factors, start=start, touches=touches) for factors in twins]
        if observer:
            play_together(correct_goals(stream, setpoints.loads, bodies, observer), bodies)
        else:
            play_together(((command,) * len(bodies) for command in stream), bodies)
        return [body.measurements() for body in bodies]

    measured = performed(touches=False)
    if min(each.clearance.distances.min() for each in measured) < robot.least_clearance:
        measured = performed(touches=True)  # between steps they may have met
    reference = Reference(planned, times, setpoints.duties)
    seconds = perf_counter() - began
    return tuple(Performance(reference, *each, parse_seconds, seconds) for each in zip(twins, measured, strict=True))


@lru_cache(maxsize=8)
def _observer(known: Setup, delay: float, bodies: int) -> Observer:
    """Its gains depend on the robot alone."""
    return Observer.of(known.robot, known.dynamics, period=1 / RATE, delay=delay, bodies=bodies)

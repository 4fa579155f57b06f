"""Joins the line with the sinks: plans a document, performs it in the twin, and reports."""

from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import Literal

from kinesic.bml.block import Dialect
from kinesic.bml.parse import parse
from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.controller.facts import Facts
from kinesic.controller.feedforward import lead
from kinesic.controller.performance import Performance
from kinesic.controller.plan import Plan
from kinesic.controller.plan import plan as plan_block
from kinesic.controller.play import RATE, commands, play, ticks
from kinesic.expressivity.lexicon import Lexicon
from kinesic.expressivity.style import Style
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.factors import NOMINAL, Factors
from kinesic.sim.twin import Twin
from kinesic.speech.durations import DurationModel


def facts(
    robot: Robot | str | Path = "upper22",
    *,
    style: Style | str = "neutral",
    lexicon: Path | None = None,
    targets: Mapping[str, Floats] | None = None,
    dialect: Dialect | Literal["auto"] = "auto",
) -> Facts:
    """What planning needs, with MuJoCo's dynamics and the built-in voice.

    Raises:
        ConfigError: robot, style or lexicon is missing or wrong.
    """
    body = robot if isinstance(robot, Robot) else Robot.load(robot)
    return Facts(
        robot=body,
        style=style if isinstance(style, Style) else Style.load(style),
        lexicon=Lexicon.load(lexicon),
        voice=DurationModel(),
        dynamics=MujocoDynamics(body),
        distances=CapsuleDistances(body),
        targets=dict(targets or {}),
        dialect=dialect,
    )


def plan(text: str | bytes, known: Facts | None = None, *, source: str = "<text>") -> Plan:
    """Plans a BML document; nothing moves.

    Raises:
        BmlError: the document is refused.
    """
    known = known or facts()
    return plan_block(parse(text, source=source, dialect=known.dialect), known)


def perform(
    text: str | bytes, known: Facts | None = None, *, source: str = "<text>", twin: Factors = NOMINAL
) -> Performance:
    """Plans a BML document and performs it in the twin.

    Raises:
        BmlError: the document is refused.
    """
    known = known or facts()
    began = perf_counter()
    block = parse(text, source=source, dialect=known.dialect)
    parsed = perf_counter() - began
    planned = plan_block(block, known)
    return dry_run(planned, twin=twin, parse_seconds=parsed)


def dry_run(planned: Plan, *, twin: Factors = NOMINAL, parse_seconds: float = 0.0) -> Performance:
    """Performs a plan in the twin."""
    known, trajectory = planned.facts, planned.trajectory
    began = perf_counter()
    times = ticks(planned.duration)
    setpoints = lead(trajectory, times, known.robot, known.dynamics, period=1 / RATE)
    body = Twin(known.robot, factors=twin, start=trajectory.at(0.0).angles)
    play(commands(trajectory, times, setpoints), body)
    return Performance(planned, body.measurements(), setpoints.duties, parse_seconds, perf_counter() - began)

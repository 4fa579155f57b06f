"""Joins planning with the twin: plans a BML document and performs it."""

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from time import perf_counter
from typing import Unpack

import numpy as np

from kinesic.body.arrays import Floats, seal_own, sealed
from kinesic.body.choices import Terms
from kinesic.body.command import RATE, Measurements
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.controller.closed_loop import perform_in_twins
from kinesic.controller.documents import read_block
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.learned_gains import soften
from kinesic.controller.observer import Observer
from kinesic.controller.options import PlanningOptions, check_options
from kinesic.controller.performance import Performance, Reference
from kinesic.controller.play import command_times
from kinesic.controller.stability import calm_part
from kinesic.controller.watch.clearance import slows
from kinesic.controller.watch.watched_run import perform_watched
from kinesic.expressivity.context import read_targets
from kinesic.expressivity.idle import Idling
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.variation import Variation
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import IntentionFiles, Setup
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.stepping.simulation import borrow_simulations
from kinesic.sim.twin import STEP, Twin
from kinesic.speech.voice import voice as make_voice


def set_up(
    robot: Robot | str | Path = "upper22", *, style: Style | str | Path = "neutral", **options: Unpack[PlanningOptions]
) -> Setup:
    """Loads what planning needs, with MuJoCo's dynamics.

    The voice is the silent one unless another is asked for, so that times are the same on every machine; nothing idles
    and nothing varies, so that figures compare.

    Args:
        robot: its name, or its TOML file.
        style: its name, or its TOML file.
        options: see `PlanningOptions`.

    Raises:
        ConfigError: something is missing or wrong; says what would have worked.
        TypeError: there is no such option.
    """
    check_options(options)
    body = robot if isinstance(robot, Robot) else load_robot(robot)
    manner = style if isinstance(style, Style) else Style.load(style)
    lexicon, seed = options.get("lexicon"), options.get("seed", 0)
    return Setup(
        robot=body,
        style=manner.changed(_settings(options.get("settings", ()))),
        lexicon=Lexicon.load(_path(lexicon)),
        voice=make_voice(options.get("voice", "durations")),
        dynamics=MujocoDynamics(body),
        distances=CapsuleDistances(body),
        targets=_targets(options.get("targets")),
        dialect=options.get("dialect", "auto"),
        gathering=options.get("gather", "complex"),
        idling=Idling(options.get("idle", 0.0), seed),
        variation=Variation(options.get("variation", 0.0), seed),
        pause=options.get("pause", 0.0),
        character=options.get("character"),
        language=options.get("language", "en"),
        grammar=options.get("grammar", "rules"),
        intentions=IntentionFiles(
            _path(options.get("intentions")), _path(options.get("baseline")), _path(options.get("qualifiers"))
        ),
    )


def _path(given: str | Path | None) -> Path | None:
    return None if given is None else Path(given)


def _settings(given: Mapping[str, float] | Sequence[str]) -> Iterable[str]:
    """Single numbers of a style as it reads them."""
    if isinstance(given, Mapping):
        return (f"{name}={float(value)!r}" for name, value in given.items())
    return given


def _targets(given: str | Path | Mapping[str, Sequence[float] | Floats] | None) -> Mapping[str, Floats]:
    if isinstance(given, str | Path):
        return read_targets(Path(given))
    found = {name: sealed(np.array(point, dtype=np.float64)) for name, point in (given or {}).items()}
    for name, point in found.items():
        if point.shape != (3,) or not np.isfinite(point).all():
            raise ConfigError(f"target {name} is {point.tolist()}; it needs three finite numbers x, y, z in metres")
    return found


def facts(
    robot: Robot | str | Path = "upper22", *, style: Style | str | Path = "neutral", **options: Unpack[PlanningOptions]
) -> Setup:
    """Does what `set_up` does. Deprecated: use `kinesic.Performer`; it goes with the next release."""
    warnings.warn("facts is deprecated: use kinesic.Performer, or set_up", DeprecationWarning, stacklevel=2)
    return set_up(robot, style=style, **options)


def plan(text: str | bytes, known: Setup | None = None, *, source: str = "<text>") -> Plan:
    """Plans a BML document; nothing moves.

    Raises:
        BmlError: the document is refused.
    """
    known = known or set_up()
    return plan_block(read_block(text, known, source=source), known)


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
    block = read_block(text, known, source=source)
    parsed = perf_counter() - began
    planned = plan_block(block, known)
    return dry_runs(planned, twins, feedforward=feedforward, correction=correction, parse_seconds=parsed)


def dry_run(
    planned: Plan,
    *,
    twin: Factors = NOMINAL,
    feedforward: Terms = "full",
    correction: bool = True,
    watch: bool = True,
    delay: float = 0.0,
    believed: Factors = NOMINAL,
) -> Performance:
    """Performs a plan in one twin: see `dry_runs`."""
    return dry_runs(
        planned, (twin,), feedforward=feedforward, correction=correction, watch=watch, delay=delay, believed=believed
    )[0]


def dry_runs(
    planned: Plan,
    twins: Sequence[Factors],
    *,
    feedforward: Terms = "full",
    correction: bool = True,
    watch: bool = True,
    delay: float = 0.0,
    believed: Factors = NOMINAL,
    step: float = STEP,
    parse_seconds: float = 0.0,
    progress: Callable[[float], None] = lambda share: None,
) -> tuple[Performance, ...]:
    """Performs a plan in several twins at once, tick by tick, so that they share what does not depend on them.

    Args:
        planned: what is performed.
        twins: how far each twin is from the robot's description.
        feedforward: what of the servos' model is inverted.
        correction: whether goals are corrected by what the twins measure.
        watch: whether a twin whose errors leave too little clearance is slowed down, and stopped before contact.
        delay: [s] of the bus, as feed-forward and correction believe it to be; the twins' own is in their factors.
        believed: how servos are believed to be, by which goals lead; such as an earlier performance told (`learn`).
        step: [s] of the physics, at most; a watched run has its own.
        parse_seconds: for the report.
        progress: gets the share of the ticks that are over, now and then.
    """
    known, trajectory, robot = planned.setup, planned.trajectory, planned.setup.robot
    began = perf_counter()
    times = command_times(planned.duration)
    leading = FeedForward.of(robot, known.dynamics, believed, delay=delay, terms=feedforward)
    delay = float(leading.delay)
    observers = partial(_copy_observer, known, believed, delay) if correction else None
    lead, start = partial(leading.lead, trajectory), trajectory.at(0.0).angles
    duties = np.empty((len(times), len(start)))

    def performed(*, touches: bool) -> list[Measurements]:
        with borrow_simulations(robot, twins, touches=touches) as simulations:
            bodies = [
                Twin(robot, factors=factors, step=step, start=start, touches=touches, simulation=simulation)
                for factors, simulation in zip(twins, simulations, strict=True)
            ]
            recorders = [body.recorder(len(times)) for body in bodies]
            for stretch in perform_in_twins(trajectory, times, lead, bodies, observers, progress):
                bodies[stretch.twin].record(recorders[stretch.twin])  # at once, while its steps are in the cache
                duties[stretch.commands] = stretch.setpoints.duties
            return [recorder.measurements() for recorder in recorders]

    alone = observers(1) if observers else None
    restoring = 1.0 if alone is None else alone.restoring
    measured = performed(touches=False)
    if min(each.clearance.distances.min() for each in measured) < robot.least_clearance:
        measured = performed(touches=True)  # between steps they may have met
    reference, seconds = Reference(planned, times, seal_own(duties)), perf_counter() - began
    runs = [
        Performance(reference, factors, each, parse_seconds, seconds, believed=believed, restoring=restoring)
        for factors, each in zip(twins, measured, strict=True)
    ]
    return tuple(_watched(run, leading, alone) if watch and slows(run.rooms, robot) else run for run in runs)


def _watched(even: Performance, feedforward: FeedForward, observer: Observer | None) -> Performance:
    """The same plan in the same twin, slowed down where its errors leave too little clearance."""
    began, plan = perf_counter(), even.plan
    twin = Twin(plan.setup.robot, factors=even.twin, start=plan.trajectory.at(0.0).angles)
    run = perform_watched(plan, twin, feedforward, observer)
    seconds = even.dry_run_seconds + perf_counter() - began
    return Performance(
        Reference(plan, run.times, run.duties),
        even.twin,
        run.measured,
        even.parse_seconds,
        seconds,
        run.least_pace,
        even.believed,
        even.restoring,
    )


@lru_cache(maxsize=8)
def make_observer(known: Setup, believed: Factors, delay: float, bodies: int) -> Observer:
    """Makes one for a robot as soft as its servos are believed to be, which restores as much as they bear."""
    design = partial(Observer.of, soften(known.robot, believed), known.dynamics, period=1 / RATE, delay=delay)
    part = calm_part(design(), believed.applied(known.robot), known.dynamics, delay)
    return replace(design(bodies=bodies), restoring=part)


def _copy_observer(known: Setup, believed: Factors, delay: float, bodies: int) -> Observer:
    """Copies what `make_observer` has made, with memory of its own: so threads may perform at once."""
    return replace(make_observer(known, believed, delay, bodies))

"""A gesture played at several values of one parameter of expressivity, and its pictures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from kinesic.body.arrays import Floats
from kinesic.body.config import CONFIGS, ConfigError, suggestion
from kinesic.controller.perform import perform
from kinesic.expressivity.style.style import RANGES, Style
from kinesic.planning.setup import Setup
from kinesic.studies.sweep.measures import SHOWN, Measures, measures
from kinesic.tasks.engine import engine_in_use
from kinesic.tasks.processes import WorkerCrash

STROKE = 6.0  # [s] block time at which the stroke is asked for: time for the slowest preparation
COUNT = 5  # values over a range, ends included
LATE = 0.010  # [s] from the asked time, beyond which a stroke is late
ID = "swept"
ONE_GESTURE = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="sweep">'
    '<gesture id="{id}" lexeme="{lexeme}" stroke="{stroke}"/></bml>'
)
SMALL = 7.5  # [pt]
INK, FAINT, OWN = "#333333", "#8a8a8a", "#b3261e"
COLOURS = colormaps["viridis"]
VIEWS = (("from the front", 1), ("from its right", 0))  # title, coordinate that runs across
OTHERS = ("peak_speed", "path_length", "jerk", "overshoot", "torso_travel", "shoulder_travel", "energy", "stroke_error")
DPI = 100


@dataclass(frozen=True)
class Measure:
    """What a parameter changes: a field of `Measures`, and in which direction it grows with the parameter."""

    name: str
    sign: float  # 1: grows; -1: shrinks


MEASURE_OF: Mapping[str, Measure] = {
    "spatial": Measure("swept_volume", 1.0),
    "temporal": Measure("preparation", -1.0),
    "fluidity": Measure("jerk", -1.0),
    "power": Measure("stroke_speed", 1.0),
    "tension": Measure("curvature", 1.0),
    "openness": Measure("elbow_offset", 1.0),
    "repetition": Measure("strokes", 1.0),
    "activation": Measure("energy", 1.0),
}


@dataclass(frozen=True, eq=False)
class Played:
    """A gesture at one value of the parameter, as the twin performed it."""

    value: float
    measures: Measures
    hands: Mapping[str, Floats]  # side -> (m, 3) [m] path in the world, of the gesture alone
    times: Floats  # (m,) [s] after the asked stroke

    @property
    def in_time(self) -> bool:
        """Whether the stroke came when it was asked for."""
        error = self.measures.stroke_error
        return error is not None and abs(error) <= LATE


@dataclass(frozen=True, eq=False)
class Series:
    """A gesture at several values of one parameter."""

    gesture: str
    parameter: str
    played: tuple[Played, ...]  # by increasing value

    @property
    def own(self) -> tuple[float | None, ...]:
        """The parameter's own measure at each value, with the sign with which it should grow."""
        measure = MEASURE_OF[self.parameter]
        found = [getattr(one.measures, measure.name) for one in self.played]
        return tuple(None if value is None else measure.sign * value for value in found)

    @property
    def monotone(self) -> bool:
        """Whether the parameter's own measure grows with each value; a count may stay, but not throughout."""
        own = self.own
        if any(value is None for value in own):
            return False
        if len(own) < 2:
            return True
        steps = np.diff(np.array(own, dtype=float))
        counted = isinstance(getattr(self.played[0].measures, MEASURE_OF[self.parameter].name), int)
        return bool((steps >= 0.0).all() and steps.sum() > 0.0) if counted else bool((steps > 0.0).all())

    @property
    def worst_stroke(self) -> float | None:
        """Largest distance of a stroke from the time it was asked for [s]; None: one never came."""
        errors = [one.measures.stroke_error for one in self.played]
        known = [abs(error) for error in errors if error is not None]
        return max(known) if len(known) == len(errors) else None

    @property
    def in_time(self) -> bool:
        """Whether every stroke came when it was asked for."""
        return all(one.in_time for one in self.played)


@dataclass(frozen=True)
class SweepTask:
    """A gesture to be played at one value of one parameter, or in a preset of style where there is no parameter."""

    gesture: str
    style: Style
    where: str  # for the message when it cannot be performed
    value: float


def sweep_parameter(gesture: str, parameter: str, setup: Setup, *, values: Sequence[float] = ()) -> Series:
    """Plays a gesture at several values of a parameter, all else as in the style, and measures each in the twin.

    Args:
        gesture: a lexeme.
        parameter: of expressivity.
        setup: with the style that the parameter is changed in.
        values: within the parameter's range; evenly over all of it when none are given.

    Raises:
        ConfigError: no such gesture or parameter, or a value out of range.
    """
    return Series(gesture, parameter, tuple(play(task, setup) for task in tasks_of(gesture, parameter, setup, values)))


def tasks_of(gesture: str, parameter: str, setup: Setup, values: Sequence[float] = ()) -> list[SweepTask]:
    """Lists what is to be played for `sweep_parameter`, which raises the same."""
    if parameter not in RANGES:
        raise ConfigError(f"a style has no {parameter}{suggestion(parameter, list(RANGES))}")
    _check(gesture, setup)
    chosen = sorted(set(values)) or np.linspace(*RANGES[parameter], COUNT).tolist()
    styles = [setup.style.changed([f"{parameter}={value!r}"]) for value in chosen]
    return [
        SweepTask(gesture, style, f"{parameter} {value:g}", value) for style, value in zip(styles, chosen, strict=True)
    ]


def play_all(tasks: Sequence[SweepTask], make_setup: Callable[[], Setup]) -> list[Played]:
    """Plays gestures by the engine in use; what was played comes in the order of the tasks.

    Args:
        tasks: what is to be played.
        make_setup: called once in each worker; picklable.

    Raises:
        ConfigError: one cannot be performed, or kills its process.
    """
    found: dict[str, Played] = {}
    for task, result in engine_in_use().run(tasks, partial(_prepare, make_setup), preload=__name__):
        if isinstance(result, WorkerCrash):
            raise ConfigError(f"{task.gesture} at {task.where}: {result.reason}")
        if isinstance(result, str):
            raise ConfigError(result)
        found[task.where] = result
    return [found[task.where] for task in tasks]


def _prepare(make_setup: Callable[[], Setup]) -> Callable[[SweepTask], Played | str]:
    known = make_setup()

    def do(task: SweepTask) -> Played | str:
        try:
            return play(task, known)
        except ConfigError as error:
            return str(error)

    return do


def preset_tasks(gesture: str, setup: Setup) -> Mapping[str, SweepTask]:
    """Lists what is to be played to compare every preset of `configs/styles/`, by name; the value of each is 0.

    Raises:
        ConfigError: no such gesture.
    """
    _check(gesture, setup)
    names = sorted(path.stem for path in (CONFIGS / "styles").glob("*.toml"))
    return {name: SweepTask(gesture, Style.load(name), name, 0.0) for name in names}


def play(task: SweepTask, setup: Setup) -> Played:
    """Plays one gesture in the twin and measures it.

    Raises:
        ConfigError: it cannot be performed.
    """
    return _played(task.gesture, replace(setup, style=task.style), task.where, task.value)


def draw_series(series: Series, path: Path) -> Path:
    """Draws one series as a PNG; returns its path."""
    figure = Figure(figsize=(11.0, 6.2), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(f"{series.gesture}: {series.parameter}", fontsize=11, color=INK)
    axes = figure.subplots(3, 4)
    shades = [COLOURS(0.9 * k / max(1, len(series.played) - 1)) for k in range(len(series.played))]
    for place, (title, across) in zip(axes[0, :2], VIEWS, strict=True):
        _paths(place, series.played, shades, across, title=title)
    _speeds(axes[0, 2], series.played, shades)
    own = MEASURE_OF[series.parameter].name
    _measure(axes[0, 3], series, own, OWN)
    for place, name in zip(axes[1:].flat, OTHERS, strict=True):
        _measure(place, series, name, OWN if name == own else INK)
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    return path


def _paths(axes: Axes, played: Sequence[Played], shades: Sequence[object], across: int, *, title: str) -> None:
    for one, shade in zip(played, shades, strict=True):
        for hand in one.hands.values():
            axes.plot(hand[:, across], hand[:, 2], color=shade, linewidth=1.0)
    axes.set_aspect("equal", adjustable="datalim")
    _plain(axes, f"hands {title} [m]")


def _speeds(axes: Axes, played: Sequence[Played], shades: Sequence[object]) -> None:
    for one, shade in zip(played, shades, strict=True):
        speeds = [np.linalg.norm(np.gradient(hand, one.times, axis=0), axis=1) for hand in one.hands.values()]
        axes.plot(one.times, np.max(speeds, axis=0), color=shade, linewidth=1.0, label=f"{one.value:g}")
    axes.axvline(0.0, color=FAINT, linewidth=0.6)
    axes.legend(fontsize=SMALL, frameon=False, handlelength=1.0, loc="upper right")
    _plain(axes, "hand speed [m/s] over time from the stroke [s]")


def _measure(axes: Axes, series: Series, name: str, colour: str) -> None:
    shown = SHOWN[name]
    found = [(one.value, getattr(one.measures, name)) for one in series.played]
    known = [(value, shown.scale * measured) for value, measured in found if measured is not None]
    if known:
        axes.plot(*zip(*known, strict=True), color=colour, marker="o", markersize=3, linewidth=1.2)
    if name != "stroke_error":
        axes.set_ylim(bottom=0.0)
    _plain(axes, f"{shown.words} [{shown.unit}]" if shown.unit else shown.words)


def _plain(axes: Axes, title: str) -> None:
    axes.set_title(title, fontsize=SMALL + 1, color=INK)
    axes.tick_params(length=2, width=0.5, labelsize=SMALL, labelcolor=FAINT)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.grid(alpha=0.3)


def _check(gesture: str, setup: Setup) -> None:
    match = setup.lexicon.find(gesture)
    if match is None or match.kind != "exact" or not match.form.keys:
        raise ConfigError(f"no gesture {gesture}{suggestion(gesture, [form.id for form in setup.lexicon.forms])}")


def _played(gesture: str, setup: Setup, where: str, value: float) -> Played:
    """Performs a gesture in the twin and measures it; `where` is for the message when it cannot be performed."""
    performance = perform(ONE_GESTURE.format(id=ID, lexeme=gesture, stroke=STROKE), setup, source=gesture)
    outcome = performance.plan.keyframes.outcomes[ID]
    if outcome.kind == "dropped":
        raise ConfigError(f"{gesture} cannot be performed at {where}: {outcome.why}")
    times, zero = performance.measured.times, performance.plan.trajectory.zero
    own = [zero + sync.planned for sync in performance.plan.syncs if sync.behaviour == ID]
    part = slice(*times.searchsorted([min(own), max(own)]))
    hands = {side: path[part] for side, path in performance.measured.hands.items()}
    return Played(value, measures(performance, ID), hands, times[part] - zero - STROKE)

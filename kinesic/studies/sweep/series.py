"""Series of a gesture over one expressivity parameter, with plots."""

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
from kinesic.controller.dry_run import dry_run
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, Style
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan
from kinesic.studies.sweep.measures import MEASURE_FORMATS, Measures, measures
from kinesic.tasks.engine import current_engine
from kinesic.tasks.processes import WorkerCrash

STROKE_TIME = 6.0  # [s] requested stroke time, late enough for the slowest preparation
VALUE_COUNT = 5  # number of values of a swept parameter over its range, ends included
MAX_STROKE_ERROR = 0.010  # [s] largest timing error, early or late, of a stroke in time
GESTURE_ID = "swept"  # id of the swept gesture in its document
GESTURE_TEMPLATE = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="sweep">'
    '<gesture id="{id}" lexeme="{lexeme}" stroke="{stroke}"/></bml>'
)
LABEL_SIZE = 7.5  # [pt] font size of plot labels
INK_COLOUR = "#333333"  # colour of texts and axes
FAINT_COLOUR = "#8a8a8a"  # colour of zero lines and tick labels
MAIN_MEASURE_COLOUR = "#b3261e"  # colour of the measure that the parameter should change
VALUE_COLOURS = colormaps["viridis"]  # colours of paths by parameter value
PATH_VIEWS = (("from the front", 1), ("from its right", 0))  # title and index of the horizontal coordinate
OTHER_MEASURES = (
    "peak_speed",
    "path_length",
    "jerk",
    "overshoot",
    "torso_travel",
    "shoulder_travel",
    "energy",
    "stroke_error",
)
PLOT_DPI = 100  # [pixels/inch] resolution of the saved plot


@dataclass(frozen=True)
class Measure:
    """Measure that a parameter should affect, with the expected direction."""

    name: str
    sign: float  # 1: increases, -1: decreases


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
    """A gesture performed in the twin at one parameter value."""

    value: float
    measures: Measures
    hands: Mapping[str, Floats]  # side -> path of the gesture (m, 3) [m] in the world
    times: Floats  # (m,) [s] after the requested stroke

    @property
    def in_time(self) -> bool:
        """Whether the stroke's timing error is within `MAX_STROKE_ERROR`."""
        error = self.measures.stroke_error
        return error is not None and abs(error) <= MAX_STROKE_ERROR


@dataclass(frozen=True, eq=False)
class Series:
    """A gesture performed at several values of one parameter."""

    gesture: str
    parameter: str
    played: tuple[Played, ...]  # by increasing value

    @property
    def main_measure(self) -> tuple[float | None, ...]:
        """Main measure at each parameter value, negated if it should decrease."""
        measure = MEASURE_OF[self.parameter]
        results = [getattr(one.measures, measure.name) for one in self.played]
        return tuple(None if value is None else measure.sign * value for value in results)

    @property
    def monotone(self) -> bool:
        """Whether the main measure increases with each parameter value.

        A count may stay equal, but not over the whole range.
        """
        main_measure = self.main_measure
        if any(value is None for value in main_measure):
            return False
        if len(main_measure) < 2:
            return True
        steps = np.diff(np.array(main_measure, dtype=float))
        counted = isinstance(getattr(self.played[0].measures, MEASURE_OF[self.parameter].name), int)
        return bool((steps >= 0.0).all() and steps.sum() > 0.0) if counted else bool((steps > 0.0).all())

    @property
    def worst_stroke(self) -> float | None:
        """Largest timing error of a stroke in the series [s].

        The result is None if a stroke never arrived.
        """
        errors = [one.measures.stroke_error for one in self.played]
        known_values = [abs(error) for error in errors if error is not None]
        return max(known_values) if len(known_values) == len(errors) else None

    @property
    def in_time(self) -> bool:
        """Whether every stroke's timing error is within `MAX_STROKE_ERROR`."""
        return all(one.in_time for one in self.played)


@dataclass(frozen=True)
class SweepTask:
    """Gesture with a parameter value or a style preset."""

    gesture: str
    style: Style
    condition: str  # condition, named in error messages
    value: float


def sweep_parameter(gesture: str, parameter: str, setup: Setup, *, values: Sequence[float] = ()) -> Series:
    """Measure a gesture at several values of a parameter.

    Args:
        gesture: lexeme of the gesture.
        parameter: parameter of expressivity.
        setup: setup with the style in which the parameter is changed.
        values: values within the parameter's range; empty: even steps over the range.

    Raises:
        ConfigError: the gesture or parameter does not exist, or a value is out of range.
    """
    return Series(
        gesture, parameter, tuple(play_task(task, setup) for task in tasks_of(gesture, parameter, setup, values))
    )


def tasks_of(gesture: str, parameter: str, setup: Setup, values: Sequence[float] = ()) -> list[SweepTask]:
    """List the tasks of `sweep_parameter`, one for each parameter value."""
    if parameter not in EXPRESSIVITY_RANGES:
        raise ConfigError(f"a style has no {parameter}{suggestion(parameter, list(EXPRESSIVITY_RANGES))}")
    _check(gesture, setup)
    chosen = sorted(set(values)) or np.linspace(*EXPRESSIVITY_RANGES[parameter], VALUE_COUNT).tolist()
    styles = [setup.style.changed([f"{parameter}={value!r}"]) for value in chosen]
    return [
        SweepTask(gesture, style, f"{parameter} {value:g}", value) for style, value in zip(styles, chosen, strict=True)
    ]


def play_all(tasks: Sequence[SweepTask], make_setup: Callable[[], Setup]) -> list[Played]:
    """Perform sweep tasks on the current task engine, in task order.

    Args:
        tasks: tasks to perform.
        make_setup: called once in each worker; picklable.

    Raises:
        ConfigError: a gesture cannot be performed, or crashes its worker.
    """
    results: dict[str, Played] = {}
    for task, result in current_engine().run(tasks, partial(_prepare, make_setup), preload=__name__):
        if isinstance(result, WorkerCrash):
            raise ConfigError(f"{task.gesture} at {task.condition}: {result.reason}")
        if isinstance(result, str):
            raise ConfigError(result)
        results[task.condition] = result
    return [results[task.condition] for task in tasks]


def _prepare(make_setup: Callable[[], Setup]) -> Callable[[SweepTask], Played | str]:
    known_values = make_setup()

    def do(task: SweepTask) -> Played | str:
        try:
            return play_task(task, known_values)
        except ConfigError as error:
            return str(error)

    return do


def preset_tasks(gesture: str, setup: Setup) -> Mapping[str, SweepTask]:
    """List the tasks for all presets of `configs/styles/`, by name.

    Their parameter value is 0.

    Raises:
        ConfigError: the gesture does not exist.
    """
    _check(gesture, setup)
    names = sorted(path.stem for path in (CONFIGS / "styles").glob("*.toml"))
    return {name: SweepTask(gesture, Style.load(name), name, 0.0) for name in names}


def play_task(task: SweepTask, setup: Setup) -> Played:
    """Perform one gesture in the twin and measure it.

    Raises:
        ConfigError: it cannot be performed.
    """
    return _perform(task.gesture, replace(setup, style=task.style), task.condition, task.value)


def draw_series(series: Series, path: Path) -> Path:
    """Draw one parameter series as PNG and return its path."""
    figure = Figure(figsize=(11.0, 6.2), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(f"{series.gesture}: {series.parameter}", fontsize=11, color=INK_COLOUR)
    axes = figure.subplots(3, 4)
    shades = [VALUE_COLOURS(0.9 * k / max(1, len(series.played) - 1)) for k in range(len(series.played))]
    for panel, (title, across) in zip(axes[0, :2], PATH_VIEWS, strict=True):
        _paths(panel, series.played, shades, across, title=title)
    _speeds(axes[0, 2], series.played, shades)
    main_measure = MEASURE_OF[series.parameter].name
    _measure(axes[0, 3], series, main_measure, MAIN_MEASURE_COLOUR)
    for panel, name in zip(axes[1:].flat, OTHER_MEASURES, strict=True):
        _measure(panel, series, name, MAIN_MEASURE_COLOUR if name == main_measure else INK_COLOUR)
    figure.savefig(path, dpi=PLOT_DPI, metadata={"Software": None})
    return path


def _paths(axes: Axes, played: Sequence[Played], shades: Sequence[object], across: int, *, title: str) -> None:
    for one, shade in zip(played, shades, strict=True):
        for hand in one.hands.values():
            axes.plot(hand[:, across], hand[:, 2], color=shade, linewidth=1.0)
    axes.set_aspect("equal", adjustable="datalim")
    _finish_axes(axes, f"hands {title} [m]")


def _speeds(axes: Axes, played: Sequence[Played], shades: Sequence[object]) -> None:
    for one, shade in zip(played, shades, strict=True):
        speeds = [np.linalg.norm(np.gradient(hand, one.times, axis=0), axis=1) for hand in one.hands.values()]
        axes.plot(one.times, np.max(speeds, axis=0), color=shade, linewidth=1.0, label=f"{one.value:g}")
    axes.axvline(0.0, color=FAINT_COLOUR, linewidth=0.6)
    axes.legend(fontsize=LABEL_SIZE, frameon=False, handlelength=1.0, loc="upper right")
    _finish_axes(axes, "hand speed [m/s] over time from the stroke [s]")


def _measure(axes: Axes, series: Series, name: str, colour: str) -> None:
    measure_format = MEASURE_FORMATS[name]
    results = [(one.value, getattr(one.measures, name)) for one in series.played]
    known_values = [(value, measure_format.scale * measured) for value, measured in results if measured is not None]
    if known_values:
        axes.plot(*zip(*known_values, strict=True), color=colour, marker="o", markersize=3, linewidth=1.2)
    if name != "stroke_error":
        axes.set_ylim(bottom=0.0)
    _finish_axes(
        axes, f"{measure_format.words} [{measure_format.unit}]" if measure_format.unit else measure_format.words
    )


def _finish_axes(axes: Axes, title: str) -> None:
    axes.set_title(title, fontsize=LABEL_SIZE + 1, color=INK_COLOUR)
    axes.tick_params(length=2, width=0.5, labelsize=LABEL_SIZE, labelcolor=FAINT_COLOUR)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.grid(alpha=0.3)


def _check(gesture: str, setup: Setup) -> None:
    match = setup.lexicon.find(gesture)
    if match is None or match.kind != "exact" or not match.form.keys:
        raise ConfigError(f"no gesture {gesture}{suggestion(gesture, [form.id for form in setup.lexicon.forms])}")


def _perform(gesture: str, setup: Setup, condition: str, value: float) -> Played:
    """Perform a gesture in the twin and measure it.

    `condition` appears in error messages.
    """
    performance = dry_run(
        plan(GESTURE_TEMPLATE.format(id=GESTURE_ID, lexeme=gesture, stroke=STROKE_TIME), setup, source=gesture)
    )
    outcome = performance.plan.keyframes.outcomes[GESTURE_ID]
    if outcome.kind == "dropped":
        raise ConfigError(f"{gesture} cannot be performed at {condition}: {outcome.why}")
    times, zero = performance.measured.times, performance.plan.trajectory.zero
    main_measure = [zero + sync.planned for sync in performance.plan.syncs if sync.behaviour == GESTURE_ID]
    part = slice(*times.searchsorted([min(main_measure), max(main_measure)]))
    hands = {side: path[part] for side, path in performance.measured.hands.items()}
    return Played(value, measures(performance, GESTURE_ID), hands, times[part] - zero - STROKE_TIME)

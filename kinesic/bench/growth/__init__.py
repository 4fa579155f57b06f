"""Benchmark of scaling with document length and joint count."""

import gc
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from time import process_time

import numpy as np

from kinesic.bench.growth.robots import make_robots
from kinesic.bench.metric import LABEL_SIZE, MAIN_COLOUR, OTHER_COLOUR, SECOND_COLOUR, Metric, label_axes, picture
from kinesic.bench.plan.plan_process import peak_memory
from kinesic.child import SLOW_IMPORTS
from kinesic.controller.dry_run import dry_run
from kinesic.planning.setup import Setup
from kinesic.report.checks import checks
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

LENGTH_PROGRAM = "kinesic.bench.growth.length_process"
DOCUMENT_LENGTHS = (1.0, 3.0, 10.0, 30.0, 60.0, 100.0, 300.0, 600.0)  # [s] durations of the measured documents
MIN_FIT_LENGTH = 10.0  # [s] shortest document in the exponent fit; shorter blocks have mostly fixed costs
SHORTER_LENGTH = 60.0  # [s] duration of the shorter of two documents whose memory is compared
LONGER_LENGTH = 600.0  # [s] duration of the longer of two documents whose memory is compared
STROKE_INTERVAL = 2.0  # [s] interval between gesture strokes of a generated document
GESTURE_LEXEMES = (
    "beat",
    "flat_surface",
    "shrug",
    "stop",
    "wave",
)  # gestures of a generated document, one after another
COMMON_LENGTH = 10.0  # [s] length of the document performed by robots of all sizes
TIME_LABELS: Mapping[str, str] = {"plan": "planning", "run": "dry run"}
MEMORY_LABELS: Mapping[str, str] = {"plan_memory": "planning", "memory": "with the dry run"}
CURVE_COLOURS: Mapping[str, str] = {
    "plan": MAIN_COLOUR,
    "run": SECOND_COLOUR,
    "plan_memory": OTHER_COLOUR,
    "memory": SECOND_COLOUR,
}
MAX_LENGTH_EXPONENT = 1.1  # goal for the exponent of CPU time over document length
MAX_JOINT_EXPONENT = 1.3  # goal for the exponent of CPU time over the number of joints
MAX_MEMORY_RATIO = 1.5  # goal for the memory of the longer document / memory of the shorter document


@dataclass(frozen=True)
class DocumentCost:
    """CPU time and memory to plan and perform a document."""

    size: float  # length [s], or number of joints
    planning: float  # [s] CPU time
    running: float  # [s] CPU time, checks included
    planning_memory: float  # [MB] peak of the process after planning
    memory: float  # [MB] peak of the process after performance and checks


def bench() -> list[Metric]:
    """Measure time and memory over document length and joint count."""
    return [
        *_exponents("length", cost_by_length(), MAX_LENGTH_EXPONENT, min_size=MIN_FIT_LENGTH, names=TIME_LABELS),
        *_compare_memory(cost_by_length()),
        *_exponents("hinges", cost_by_joints(), MAX_JOINT_EXPONENT, min_size=0.0, names=TIME_LABELS),
        *_points("length", cost_by_length(), "s", names=(*TIME_LABELS, *MEMORY_LABELS)),
        *_points("hinges", cost_by_joints(), "hinges", names=tuple(TIME_LABELS)),
    ]


def draw(folder: Path) -> list[Path]:
    """Plot time and memory by document length, and time by joint count.

    The legends give the fitted exponents.
    """
    path, lengths, length_label = folder / "growth.png", cost_by_length(), "length of the document [s]"
    with picture(path, 12.0, 3.6) as drawn:
        columns = zip(
            drawn.subplots(1, 3),
            (
                (lengths, MIN_FIT_LENGTH, TIME_LABELS),
                (lengths, MIN_FIT_LENGTH, MEMORY_LABELS),
                (cost_by_joints(), 0.0, TIME_LABELS),
            ),
            ((length_label, "s of CPU"), (length_label, "MB of the process"), ("joints", "s of CPU")),
            strict=True,
        )
        for axes, (costs, min_size, names), labels in columns:
            slopes = fit_exponents(costs, min_size=min_size)
            sizes, plot = [cost.size for cost in costs], axes.semilogx if names is MEMORY_LABELS else axes.loglog
            for name, title in names.items():
                values, label = [value_of(cost, name) for cost in costs], f"{title}, exponent {slopes[name]:.2f}"
                plot(sizes, values, "o-", color=CURVE_COLOURS[name], label=label, markersize=4)
            if names is MEMORY_LABELS:
                axes.set_ylim(bottom=0.0)
            axes.set_xticks(sizes, [f"{size:g}" for size in sizes], fontsize=LABEL_SIZE)
            axes.tick_params(axis="x", which="minor", bottom=False, labelbottom=False)
            axes.legend(fontsize=LABEL_SIZE, frameon=False)
            label_axes(axes, *labels)
    return [path]


@cache
def cost_by_length() -> tuple[DocumentCost, ...]:
    """Measure the cost of documents of increasing length on upper22.

    Each runs in a process of its own that has already performed a document of ten seconds. The memory is that of the
    whole process, with Python and all libraries.
    """
    return tuple(_measure_apart(length) for length in DOCUMENT_LENGTHS)


def _measure_apart(length: float) -> DocumentCost:
    command = [sys.executable, "-m", LENGTH_PROGRAM, str(length)]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    return DocumentCost(**json.loads(done.stdout))


@cache
def cost_by_joints() -> tuple[DocumentCost, ...]:
    """Measure the cost of one document on robots of increasing joint count."""
    warm_up_planner(set_up())
    return tuple(
        measure_document_cost(set_up(robot), COMMON_LENGTH, float(len(robot.drives))) for robot in make_robots()
    )


def warm_up_planner(setup: Setup) -> None:
    """Import slow libraries, then plan and perform a document once."""
    for name in SLOW_IMPORTS:
        import_module(name)
    measure_document_cost(setup, COMMON_LENGTH, COMMON_LENGTH)


def write_gesture_document(length: float) -> str:
    """Return a BML document of evenly spaced gestures and nods."""
    strokes = np.arange(min(1.0, length / 2), length, STROKE_INTERVAL)
    lines = [
        f'<gesture id="g{k}" lexeme="{GESTURE_LEXEMES[k % len(GESTURE_LEXEMES)]}" stroke="{stroke:.3f}"/>'
        + (f'<head id="h{k}" lexeme="NOD" start="{stroke:.3f}"/>' if k % len(GESTURE_LEXEMES) == 0 else "")
        for k, stroke in enumerate(strokes)
    ]
    return f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="long">{"".join(lines)}</bml>'


def measure_document_cost(setup: Setup, length: float, size: float) -> DocumentCost:
    """Plan and perform a document and return its cost.

    Args:
        setup: robot, style and options.
        length: length of the document [s].
        size: size stored in the cost, in seconds or joints.
    """
    text = write_gesture_document(length)
    gc.collect()
    began = process_time()
    planned = plan(text, setup)
    middle, planning_memory = process_time(), peak_memory()
    checks(dry_run(planned))
    return DocumentCost(size, middle - began, process_time() - middle, planning_memory, peak_memory())


def value_of(cost: DocumentCost, name: str) -> float:
    """Return a time [s] or memory [MB] by its metric name."""
    values = {"plan": cost.planning, "run": cost.running, "plan_memory": cost.planning_memory, "memory": cost.memory}
    return values[name]


def fit_exponents(costs: Sequence[DocumentCost], *, min_size: float) -> dict[str, float]:
    """Fit the exponent e of y = a x^e to each metric.

    Only sizes >= `min_size` count.
    """
    large_costs = [cost for cost in costs if cost.size >= min_size]
    sizes = np.log([cost.size for cost in large_costs])
    return {
        name: float(np.polyfit(sizes, np.log([value_of(cost, name) for cost in large_costs]), 1)[0])
        for name in (*TIME_LABELS, *MEMORY_LABELS)
    }


def _exponents(
    kind: str, costs: Sequence[DocumentCost], goal: float, *, min_size: float, names: Mapping[str, str]
) -> list[Metric]:
    slopes = fit_exponents(costs, min_size=min_size)
    return [Metric(f"growth.{kind}.{name}", slopes[name], "exponent", goal, "lower") for name in names]


def _compare_memory(costs: Sequence[DocumentCost]) -> list[Metric]:
    """Return the memory ratio of the longer to the shorter document."""
    by_size, why = {cost.size: cost for cost in costs}, f"{LONGER_LENGTH:g} s compared with {SHORTER_LENGTH:g} s"
    return [
        Metric(
            f"growth.length.{name}",
            value_of(by_size[LONGER_LENGTH], name) / value_of(by_size[SHORTER_LENGTH], name),
            "times",
            MAX_MEMORY_RATIO,
            "lower",
            why,
        )
        for name in MEMORY_LABELS
    ]


def _points(kind: str, costs: Sequence[DocumentCost], unit: str, *, names: Sequence[str]) -> list[Metric]:
    return [
        Metric(
            f"growth.{kind}.{cost.size:g}.{name}",
            value_of(cost, name),
            "MB" if name in MEMORY_LABELS else "s",
            None,
            "lower",
            unit,
        )
        for cost in costs
        for name in names
    ]

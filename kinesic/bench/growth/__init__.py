"""Measures how time and memory of planning and of dry runs grow with the length of a document and with hinges."""

import gc
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from time import process_time

import numpy as np

from kinesic.bench.figure import OTHERS, OURS, SECOND, SMALL, Figure, label_axes, picture
from kinesic.bench.growth.robots import robots
from kinesic.bench.plan.plan_process import peak_memory
from kinesic.controller.perform import dry_run, plan, set_up
from kinesic.planning.setup import Setup
from kinesic.report.checks import checks

LENGTHS = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 600.0)  # [s]
LONG = 10.0  # [s] from which on the exponent counts: a short block is mostly its fixed cost
PACE = 2.0  # [s] from stroke to stroke
LEXEMES = ("beat", "flat_surface", "shrug", "stop", "wave")
FORGET_PEAK = Path("/proc/self/clear_refs")  # 5 written to it makes the peak of memory begin anew
SHORT = 10.0  # [s] of the document that robots of all sizes perform
SAID: Mapping[str, str] = {"plan": "planning", "run": "dry run", "memory": "memory"}
TIMES = ("plan", "run")  # what is told by hinges: memory of a short document is lost in what is there already
UNITS: Mapping[str, str] = {"plan": "s", "run": "s", "memory": "MB"}
LINEAR, NEARLY = 1.1, 1.3  # goals: exponents in length, and in hinges


@dataclass(frozen=True)
class Cost:
    """What a document took."""

    size: float  # [s] of length, or hinges
    planning: float  # [s] of CPU
    running: float  # [s] of CPU, checks included
    memory: float  # [MB] at most, beyond what the process had before


def bench() -> list[Figure]:
    """Measures every figure of the part."""
    return [
        *_figures("length", by_length(), "s", LINEAR, least=LONG),
        *_figures("hinges", by_hinges(), "hinges", NEARLY, least=0.0, names=TIMES),
    ]


def draw(folder: Path) -> list[Path]:
    """Draws what was measured: time and memory over length and over hinges, with the fitted exponents."""
    path = folder / "growth.png"
    with picture(path, 10.0, 3.6) as drawn:
        columns = zip(
            drawn.subplots(1, 2),
            ("length of the document [s]", "hinges"),
            ((by_length(), LONG, tuple(SAID)), (by_hinges(), 0.0, TIMES)),
            strict=True,
        )
        for axes, across, (costs, least, names) in columns:
            sizes, slopes = [cost.size for cost in costs], exponents(costs, least=least)
            for name, colour in zip(names, (OURS, SECOND, OTHERS), strict=False):
                values = [figure_of(cost, name) for cost in costs]
                label = f"{SAID[name]}, exponent {slopes[name]:.2f}"
                axes.loglog(sizes, values, "o-", color=colour, label=label, markersize=4)
            axes.legend(fontsize=SMALL, frameon=False)
            label_axes(axes, across, "s of CPU; MB" if "memory" in names else "s of CPU")
    return [path]


@cache
def by_length() -> tuple[Cost, ...]:
    """Plans and performs documents of growing length, on upper22."""
    known = set_up()
    measure(known, 1.0, 1.0)  # the first one imports what it needs
    return tuple(measure(known, length, length) for length in LENGTHS)


@cache
def by_hinges() -> tuple[Cost, ...]:
    """Plans and performs the same document with robots of more and more hinges."""
    return tuple(measure(set_up(robot), SHORT, float(len(robot.drives))) for robot in robots())


def document(length: float) -> str:
    """Writes a document of gestures in even steps, and a nod to every fifth."""
    strokes = np.arange(min(1.0, length / 2), length, PACE)
    lines = [
        f'<gesture id="g{k}" lexeme="{LEXEMES[k % len(LEXEMES)]}" stroke="{stroke:.3f}"/>'
        + (f'<head id="h{k}" lexeme="NOD" start="{stroke:.3f}"/>' if k % len(LEXEMES) == 0 else "")
        for k, stroke in enumerate(strokes)
    ]
    return f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="long">{"".join(lines)}</bml>'


def measure(known: Setup, length: float, size: float) -> Cost:
    """Plans and performs a document.

    Args:
        known: who performs it.
        length: of the document [s].
        size: by which the cost is filed.
    """
    text = document(length)
    gc.collect()
    if FORGET_PEAK.exists():
        FORGET_PEAK.write_text("5", encoding="ascii")
    before, began = peak_memory(), process_time()
    planned = plan(text, known)
    middle = process_time()
    checks(dry_run(planned))
    return Cost(size, middle - began, process_time() - middle, max(peak_memory() - before, 0.1))


def figure_of(cost: Cost, name: str) -> float:
    """Looks up one of the figures of a cost by its name in `SAID`."""
    return {"plan": cost.planning, "run": cost.running, "memory": cost.memory}[name]


def exponents(costs: Sequence[Cost], *, least: float) -> dict[str, float]:
    """Fits y = a x^e to each figure, from a least size on, and gives e."""
    chosen = [cost for cost in costs if cost.size >= least]
    sizes = np.log([cost.size for cost in chosen])
    return {name: float(np.polyfit(sizes, np.log([figure_of(cost, name) for cost in chosen]), 1)[0]) for name in SAID}


def _figures(
    kind: str, costs: Sequence[Cost], unit: str, goal: float, *, least: float, names: Sequence[str] = tuple(SAID)
) -> list[Figure]:
    points = [
        Figure(f"growth.{kind}.{cost.size:g}.{name}", figure_of(cost, name), UNITS[name], None, "lower", unit)
        for cost in costs
        for name in names
    ]
    slopes = exponents(costs, least=least)
    return [Figure(f"growth.{kind}.{name}", slopes[name], "exponent", goal, "lower") for name in names] + points

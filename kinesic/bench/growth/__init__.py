"""Measures how time and memory of planning and of dry runs grow with the length of a document and with hinges."""

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

from kinesic.bench.figure import OTHERS, OURS, SECOND, SMALL, Figure, label_axes, picture
from kinesic.bench.growth.robots import robots
from kinesic.bench.plan.plan_process import peak_memory
from kinesic.child import SLOW
from kinesic.controller.perform import dry_run, plan, set_up
from kinesic.planning.setup import Setup
from kinesic.report.checks import checks

PROGRAM = "kinesic.bench.growth.length_process"
LENGTHS = (1.0, 3.0, 10.0, 30.0, 60.0, 100.0, 300.0, 600.0)  # [s]
LONG = 10.0  # [s] from which on the exponent counts: a short block is mostly its fixed cost
SHORTER, LONGER = 60.0, 600.0  # [s] between which memory is to stay flat
PACE = 2.0  # [s] from stroke to stroke
LEXEMES = ("beat", "flat_surface", "shrug", "stop", "wave")
SHORT = 10.0  # [s] of the document that robots of all sizes perform
TIMES: Mapping[str, str] = {"plan": "planning", "run": "dry run"}
MEMORY: Mapping[str, str] = {"plan_memory": "planning", "memory": "with the dry run"}
COLOURS: Mapping[str, str] = {"plan": OURS, "run": SECOND, "plan_memory": OTHERS, "memory": SECOND}
LINEAR, NEARLY = 1.1, 1.3  # goals: exponents in length, and in hinges
FLAT = 1.5  # goal: times as much memory for the longer document


@dataclass(frozen=True)
class Cost:
    """What a document took."""

    size: float  # [s] of length, or hinges
    planning: float  # [s] of CPU
    running: float  # [s] of CPU, checks included
    planning_memory: float  # [MB] of the process at most until it was planned
    memory: float  # [MB] of the process at most until it was performed and judged


def bench() -> list[Figure]:
    """Measures every figure of the part."""
    return [
        *_exponents("length", by_length(), LINEAR, least=LONG, names=TIMES),
        *_flatness(by_length()),
        *_exponents("hinges", by_hinges(), NEARLY, least=0.0, names=TIMES),
        *_points("length", by_length(), "s", names=(*TIMES, *MEMORY)),
        *_points("hinges", by_hinges(), "hinges", names=tuple(TIMES)),
    ]


def draw(folder: Path) -> list[Path]:
    """Draws what was measured: time and memory over length, and time over hinges, with the fitted exponents."""
    path, lengths, across = folder / "growth.png", by_length(), "length of the document [s]"
    with picture(path, 12.0, 3.6) as drawn:
        columns = zip(
            drawn.subplots(1, 3),
            ((lengths, LONG, TIMES), (lengths, LONG, MEMORY), (by_hinges(), 0.0, TIMES)),
            ((across, "s of CPU"), (across, "MB of the process"), ("hinges", "s of CPU")),
            strict=True,
        )
        for axes, (costs, least, names), labels in columns:
            slopes = exponents(costs, least=least)
            sizes, plot = [cost.size for cost in costs], axes.semilogx if names is MEMORY else axes.loglog
            for name, said in names.items():
                values, label = [figure_of(cost, name) for cost in costs], f"{said}, exponent {slopes[name]:.2f}"
                plot(sizes, values, "o-", color=COLOURS[name], label=label, markersize=4)
            if names is MEMORY:
                axes.set_ylim(bottom=0.0)
            axes.set_xticks(sizes, [f"{size:g}" for size in sizes], fontsize=SMALL)
            axes.tick_params(axis="x", which="minor", bottom=False, labelbottom=False)
            axes.legend(fontsize=SMALL, frameon=False)
            label_axes(axes, *labels)
    return [path]


@cache
def by_length() -> tuple[Cost, ...]:
    """Plans and performs documents of growing length, on upper22.

    Each has a process of its own, which has done one of ten seconds before. Its memory counts as a whole, with Python
    and all libraries: it is what the system has to give it.
    """
    return tuple(_measure_apart(length) for length in LENGTHS)


def _measure_apart(length: float) -> Cost:
    command = [sys.executable, "-m", PROGRAM, str(length)]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    return Cost(**json.loads(done.stdout))


@cache
def by_hinges() -> tuple[Cost, ...]:
    """Plans and performs the same document with robots of more and more hinges."""
    warm_up(set_up())
    return tuple(measure(set_up(robot), SHORT, float(len(robot.drives))) for robot in robots())


def warm_up(known: Setup) -> None:
    """Imports all that plans may need, then plans and performs a document like those that are measured."""
    for name in SLOW:
        import_module(name)
    measure(known, SHORT, SHORT)


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
    began = process_time()
    planned = plan(text, known)
    middle, planning_memory = process_time(), peak_memory()
    checks(dry_run(planned))
    return Cost(size, middle - began, process_time() - middle, planning_memory, peak_memory())


def figure_of(cost: Cost, name: str) -> float:
    """Looks up one of the figures of a cost by its name in `TIMES` or `MEMORY`."""
    every = {"plan": cost.planning, "run": cost.running, "plan_memory": cost.planning_memory, "memory": cost.memory}
    return every[name]


def exponents(costs: Sequence[Cost], *, least: float) -> dict[str, float]:
    """Fits y = a x^e to each figure, from a least size on, and gives e."""
    chosen = [cost for cost in costs if cost.size >= least]
    sizes = np.log([cost.size for cost in chosen])
    return {
        name: float(np.polyfit(sizes, np.log([figure_of(cost, name) for cost in chosen]), 1)[0])
        for name in (*TIMES, *MEMORY)
    }


def _exponents(
    kind: str, costs: Sequence[Cost], goal: float, *, least: float, names: Mapping[str, str]
) -> list[Figure]:
    slopes = exponents(costs, least=least)
    return [Figure(f"growth.{kind}.{name}", slopes[name], "exponent", goal, "lower") for name in names]


def _flatness(costs: Sequence[Cost]) -> list[Figure]:
    """Says how many times as much memory the longer document takes as the shorter one."""
    by_size, why = {cost.size: cost for cost in costs}, f"{LONGER:g} s beside {SHORTER:g} s"
    return [
        Figure(
            f"growth.length.{name}",
            figure_of(by_size[LONGER], name) / figure_of(by_size[SHORTER], name),
            "times",
            FLAT,
            "lower",
            why,
        )
        for name in MEMORY
    ]


def _points(kind: str, costs: Sequence[Cost], unit: str, *, names: Sequence[str]) -> list[Figure]:
    return [
        Figure(
            f"growth.{kind}.{cost.size:g}.{name}",
            figure_of(cost, name),
            "MB" if name in MEMORY else "s",
            None,
            "lower",
            unit,
        )
        for cost in costs
        for name in names
    ]

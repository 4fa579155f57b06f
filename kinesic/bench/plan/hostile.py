"""Hostile documents, and the CPU time and memory to plan them."""

import json
import random
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from kinesic.bench.blocks import CROWD_TEMPLATE, write_crammed_block
from kinesic.bench.metric import Metric

MAX_CPU_TIME = 10.0  # [s] CPU time goal for planning one hostile document
MAX_MEMORY = 500.0  # [MB] memory goal for planning one hostile document
CPU_LIMIT = 120  # [s] CPU time after which the planning process is killed
PLAN_PROGRAM = "kinesic.bench.plan.plan_process"

DocumentWriter = Callable[[Sequence[str]], str]  # writes a document from lexemes of gestures


@dataclass(frozen=True)
class PlanningCost:
    """CPU time and memory to plan one document."""

    cpu: float  # [s] CPU time
    memory: float  # [MB] peak of the process, kinesic itself included
    ending: str  # number of behaviours by outcome, or the reason of the refusal


def write_pile(count: int) -> DocumentWriter:
    """Return a function that writes gestures at random times within 10 s."""

    def write(lexemes: Sequence[str]) -> str:
        rng = random.Random(0)
        return _document(
            f'<gesture id="g{k}" lexeme="{rng.choice(lexemes)}" stroke="{rng.uniform(0, 10):.2f}"/>'
            for k in range(count)
        )

    return write


def write_stairs(count: int, interval: float, duration: float) -> DocumentWriter:
    """Return a function that writes long gestures starting at regular intervals [s]."""

    def write(lexemes: Sequence[str]) -> str:
        rng = random.Random(0)
        return _document(
            f'<gesture id="g{k}" lexeme="{rng.choice(lexemes)}" start="{start:.2f}" end="{start + duration:.2f}"/>'
            for k, start in ((k, interval * k) for k in range(count))
        )

    return write


def write_mob(count: int) -> DocumentWriter:
    """Return a function that writes many gestures and nods within 10 s."""
    return lambda lexemes: write_crammed_block(0, lexemes, count)


def write_regular_nods(count: int, interval: float) -> DocumentWriter:
    """Return a function that writes nods at regular intervals [s]."""
    return lambda lexemes: _document(f'<head id="h{k}" lexeme="NOD" start="{interval * k:.2f}"/>' for k in range(count))


def write_gazes(count: int) -> DocumentWriter:
    """Return a function that writes overlapping gazes to left and right."""
    return lambda lexemes: _document(
        f'<gaze id="g{k}" target="{("left", "right")[k % 2]}" start="{0.3 * k:.2f}" end="{0.3 * k + 0.6:.2f}"/>'
        for k in range(count)
    )


def write_postures(count: int, interval: float, duration: float) -> DocumentWriter:
    """Return a function that writes overlapping arm postures, which exclude each other.

    They start at regular intervals [s] and have a given length [s].
    """
    poses = ("ARMS_CROSSED", "ARMS_AKIMBO", "ARMS_OPEN", "ARMS_NEUTRAL")
    return lambda lexemes: _document(
        f'<posture id="p{k}" start="{interval * k:.2f}" end="{interval * k + duration:.2f}">'
        f'<pose part="ARMS" lexeme="{poses[k % len(poses)]}"/></posture>'
        for k in range(count)
    )


def write_ring(count: int, sync: str) -> DocumentWriter:
    """Return a function that writes nods with circular time references."""
    return lambda lexemes: _document(
        f'<head id="h{k}" lexeme="NOD" start="h{(k + 1) % count}:{sync}"/>' for k in range(count)
    )


def write_contradictions(count: int) -> DocumentWriter:
    """Return a function that writes beat gestures with contradictory constraints.

    Each beat must come a second before the seventh one after it.
    """

    def write(lexemes: Sequence[str]) -> str:
        beats = "".join(f'<gesture id="g{k}" lexeme="BEAT"/>' for k in range(count))
        ties = "".join(
            f'<synchronize ref="g{k}:stroke"><sync ref="g{(k + 7) % count}:stroke+1"/></synchronize>'
            for k in range(count)
        )
        return CROWD_TEMPLATE.format(f'{beats}<constraint id="c">{ties}</constraint>')

    return write


def write_marks(count: int) -> DocumentWriter:
    """Return a function that writes speech with many marks and some nods."""

    def write(lexemes: Sequence[str]) -> str:
        text = " ".join(f'word <sync id="m{k}"/>' for k in range(count))
        heads = "".join(f'<head id="h{k}" lexeme="NOD" stroke="s:m{k}"/>' for k in range(0, count, 5))
        return CROWD_TEMPLATE.format(f'<speech id="s"><text>{text}</text></speech>{heads}')

    return write


def _constant(content: str) -> DocumentWriter:
    return lambda lexemes: CROWD_TEMPLATE.format(content)


def _document(lines: Iterable[str]) -> str:
    return CROWD_TEMPLATE.format("".join(lines))


LONG_GAZES = (
    '<gaze id="a" target="left" start="0" end="900"/><gaze id="b" target="right" start="100" end="1000"/>'
    '<gesture id="g" lexeme="BEAT" stroke="999"/>'
)
UNREACHABLE_GESTURE = (
    '<gesture id="g" lexeme="BEAT" start="0" stroke="0.001" end="0.002"/><head id="n" lexeme="NOD" end="-1100"/>'
)
HOSTILE_DOCUMENTS: Mapping[str, DocumentWriter] = {
    **{f"pile_{count}": write_pile(count) for count in (20, 50, 100, 300)},
    **{f"mob_{count}": write_mob(count) for count in (40, 200)},
    "stairs_100": write_stairs(100, 0.05, 2.0),
    "stairs_300": write_stairs(300, 0.05, 2.0),
    "row_100": write_stairs(100, 0.3, 1.0),
    "nods_1000_s": write_regular_nods(1000, 1.0),
    "nods_hurried": write_regular_nods(1000, 0.1),
    "looks_500": write_gazes(500),
    "stances_300": write_postures(300, 0.5, 2.0),
    "ring_of_ends": write_ring(500, "end"),
    "ring_of_starts": write_ring(500, "start"),
    "contradictions": write_contradictions(200),
    "marks": write_marks(3000),
    "gazes_900_s": _constant(LONG_GAZES),
    "unreachable_times": _constant(UNREACHABLE_GESTURE),
    "huge_numbers": _constant(
        '<gesture id="g" lexeme="BEAT" stroke="1e300"/><head id="h" lexeme="NOD" amount="1e99"/>'
    ),
    "repetition": _constant('<head id="h" lexeme="NOD" repetition="10000"/>'),
    "repetition_100": _constant('<head id="h" lexeme="NOD" repetition="100" start="0" end="5"/>'),
    "attribute_2_mb": _constant(f'<gesture id="g" lexeme="{"x" * 2_000_000}"/><head id="h" lexeme="NOD"/>'),
    "nested": _constant("<required>" * 5000 + '<head id="h" lexeme="NOD"/>' + "</required>" * 5000),
}


def measure_hostile_plan(name: str) -> PlanningCost:
    """Measure the cost to plan a hostile document in another process.

    Raises:
        subprocess.CalledProcessError: the process failed.
    """
    process = subprocess.run([sys.executable, "-m", PLAN_PROGRAM, name], stdout=subprocess.PIPE, check=True)
    return PlanningCost(**json.loads(process.stdout))


def hostile_metrics(names: Sequence[str] = tuple(HOSTILE_DOCUMENTS)) -> list[Metric]:
    """Measure the largest CPU time and memory to plan hostile documents."""
    costs = [measure_hostile_plan(name) for name in names]
    return [
        Metric("plan.cpu_hostile", max(cost.cpu for cost in costs), "s", MAX_CPU_TIME, "lower"),
        Metric("plan.memory_hostile", max(cost.memory for cost in costs), "MB", MAX_MEMORY, "lower"),
    ]

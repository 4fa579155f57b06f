"""Documents that nobody writes who means well, and what it takes to plan each, in a process of its own."""

import json
import random
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from kinesic.bench.blocks import ROOT, throng
from kinesic.bench.figure import Figure

CPU, MEMORY = 10.0, 500.0  # [s] and [MB] that a plan may take
PATIENCE = 120  # [s] of CPU, after which a process is ended
PROGRAM = "kinesic.bench.plan.plan_process"

Write = Callable[[Sequence[str]], str]  # a document, from lexemes of gestures


@dataclass(frozen=True)
class Cost:
    """What the plan of a document took, without starting the process."""

    cpu: float  # [s]
    memory: float  # [MB] that the process had at most, kinesic itself included
    ending: str  # counts of outcomes, or why it was refused


def pile(count: int) -> Write:
    """So many gestures at any times within ten seconds."""

    def write(lexemes: Sequence[str]) -> str:
        chance = random.Random(0)
        return _document(
            f'<gesture id="g{k}" lexeme="{chance.choice(lexemes)}" stroke="{chance.uniform(0, 10):.2f}"/>'
            for k in range(count)
        )

    return write


def stairs(count: int, later: float, long: float) -> Write:
    """So many gestures of some length [s], each a little later [s] than the one before."""

    def write(lexemes: Sequence[str]) -> str:
        chance = random.Random(0)
        return _document(
            f'<gesture id="g{k}" lexeme="{chance.choice(lexemes)}" start="{start:.2f}" end="{start + long:.2f}"/>'
            for k, start in ((k, later * k) for k in range(count))
        )

    return write


def mob(count: int) -> Write:
    """So many gestures and as many nods at any times within ten seconds."""
    return lambda lexemes: throng(0, lexemes, count)


def nods(count: int, every: float) -> Write:
    """So many nods, one each so many seconds."""
    return lambda lexemes: _document(f'<head id="h{k}" lexeme="NOD" start="{every * k:.2f}"/>' for k in range(count))


def looks(count: int) -> Write:
    """So many looks to and fro, each begun while the one before it lasts."""
    return lambda lexemes: _document(
        f'<gaze id="g{k}" target="{("left", "right")[k % 2]}" start="{0.3 * k:.2f}" end="{0.3 * k + 0.6:.2f}"/>'
        for k in range(count)
    )


def stances(count: int, every: float, long: float) -> Write:
    """So many postures of the arms of some length [s], one each so many seconds: no body holds one after the other."""
    poses = ("ARMS_CROSSED", "ARMS_AKIMBO", "ARMS_OPEN", "ARMS_NEUTRAL")
    return lambda lexemes: _document(
        f'<posture id="p{k}" start="{every * k:.2f}" end="{every * k + long:.2f}">'
        f'<pose part="ARMS" lexeme="{poses[k % len(poses)]}"/></posture>'
        for k in range(count)
    )


def ring(count: int, sync: str) -> Write:
    """So many nods, each of which begins at a sync point of the next one, and the last at that of the first."""
    return lambda lexemes: _document(
        f'<head id="h{k}" lexeme="NOD" start="h{(k + 1) % count}:{sync}"/>' for k in range(count)
    )


def contradictions(count: int) -> Write:
    """So many beats that are each to come a second before the seventh after it."""

    def write(lexemes: Sequence[str]) -> str:
        beats = "".join(f'<gesture id="g{k}" lexeme="BEAT"/>' for k in range(count))
        ties = "".join(
            f'<synchronize ref="g{k}:stroke"><sync ref="g{(k + 7) % count}:stroke+1"/></synchronize>'
            for k in range(count)
        )
        return ROOT.format(f'{beats}<constraint id="c">{ties}</constraint>')

    return write


def marks(count: int) -> Write:
    """A speech with so many marks, with a nod at every fifth."""

    def write(lexemes: Sequence[str]) -> str:
        text = " ".join(f'word <sync id="m{k}"/>' for k in range(count))
        heads = "".join(f'<head id="h{k}" lexeme="NOD" stroke="s:m{k}"/>' for k in range(0, count, 5))
        return ROOT.format(f'<speech id="s"><text>{text}</text></speech>{heads}')

    return write


def _always(inside: str) -> Write:
    return lambda lexemes: ROOT.format(inside)


def _document(lines: Iterable[str]) -> str:
    return ROOT.format("".join(lines))


GAZES = (
    '<gaze id="a" target="left" start="0" end="900"/><gaze id="b" target="right" start="100" end="1000"/>'
    '<gesture id="g" lexeme="BEAT" stroke="999"/>'
)
FAR = '<gesture id="g" lexeme="BEAT" start="0" stroke="0.001" end="0.002"/><head id="n" lexeme="NOD" end="-1100"/>'
DOCUMENTS: Mapping[str, Write] = {
    **{f"pile_{count}": pile(count) for count in (20, 50, 100, 300)},
    **{f"mob_{count}": mob(count) for count in (40, 200)},
    "stairs_100": stairs(100, 0.05, 2.0),
    "stairs_300": stairs(300, 0.05, 2.0),
    "row_100": stairs(100, 0.3, 1.0),
    "nods_1000_s": nods(1000, 1.0),
    "nods_hurried": nods(1000, 0.1),
    "looks_500": looks(500),
    "stances_300": stances(300, 0.5, 2.0),
    "ring_of_ends": ring(500, "end"),
    "ring_of_starts": ring(500, "start"),
    "contradictions": contradictions(200),
    "marks": marks(3000),
    "gazes_900_s": _always(GAZES),
    "unreachable_times": _always(FAR),
    "huge_numbers": _always('<gesture id="g" lexeme="BEAT" stroke="1e300"/><head id="h" lexeme="NOD" amount="1e99"/>'),
    "repetition": _always('<head id="h" lexeme="NOD" repetition="10000"/>'),
    "repetition_100": _always('<head id="h" lexeme="NOD" repetition="100" start="0" end="5"/>'),
    "attribute_2_mb": _always(f'<gesture id="g" lexeme="{"x" * 2_000_000}"/><head id="h" lexeme="NOD"/>'),
    "nested": _always("<required>" * 5000 + '<head id="h" lexeme="NOD"/>' + "</required>" * 5000),
}


def measure_plan(name: str) -> Cost:
    """Plans a document of `DOCUMENTS` in a process of its own, which is ended when it takes far too long.

    Raises:
        subprocess.CalledProcessError: the process did not end well.
    """
    done = subprocess.run([sys.executable, "-m", PROGRAM, name], stdout=subprocess.PIPE, check=True)
    return Cost(**json.loads(done.stdout))


def figures(names: Sequence[str] = tuple(DOCUMENTS)) -> list[Figure]:
    """Measures the worst of some documents."""
    costs = [measure_plan(name) for name in names]
    return [
        Figure("plan.cpu_hostile", max(cost.cpu for cost in costs), "s", CPU, "lower"),
        Figure("plan.memory_hostile", max(cost.memory for cost in costs), "MB", MEMORY, "lower"),
    ]

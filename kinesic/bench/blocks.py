"""BML blocks for benchmarks: a passage, overlapping gestures and corpus documents.

The passage lasts about five seconds and moves both hands, head and torso; its times shift at every repetition.
Overlapping gestures are too dense for any servo. Generated blocks and the choice of documents depend on a seed only.
The corpus was written by third parties and is not part of the project.
"""

import os
import random
from collections.abc import Sequence
from pathlib import Path

from kinesic.bml.block import BmlError
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.report.batch import documents
from kinesic.session.plan import plan

PASSAGE_BML = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="passage">
  <gesture id="g1" lexeme="offer" mode="BOTH_HANDS" start="{0:.3f}" stroke="{1:.3f}" end="{2:.3f}"/>
  <gesture id="g2" lexeme="beat" mode="RIGHT_HAND" stroke="{3:.3f}"/>
  <gesture id="g3" lexeme="large" mode="BOTH_HANDS" stroke="{4:.3f}" end="{5:.3f}"/>
  <head id="h1" lexeme="NOD" amount="0.6" start="{6:.3f}"/>
  <head id="h2" lexeme="NOD" amount="0.4" repetition="2" start="{7:.3f}"/>
  <gaze id="z1" target="left" start="{8:.3f}" end="{9:.3f}"/>
</bml>
"""
PASSAGE_TIMES = (
    0.2,
    1.0,
    2.2,
    2.7,
    3.9,
    5.0,
    0.4,
    2.0,
    3.4,
    4.7,
)  # [s] times of the behaviours in PASSAGE_BML, without delay
CROWD_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="crowd">{}</bml>'
HAND_MODES = ("LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS")  # values of a gesture's attribute `mode`
CORPUS_SEED = 50  # seed of the random order of corpus documents
MAX_BLOCK_DURATION = 60.0  # [s] corpus documents with a longer plan are skipped


def write_passage(repetition: int) -> str:
    """Return the benchmark's fixed BML block, delayed by 0 to 48 ms.

    The delay is 3 ms times `repetition` modulo 17, so that planning reuses few cached results.
    """
    return PASSAGE_BML.format(*(time + 0.003 * (repetition % 17) for time in PASSAGE_TIMES))


def write_overlapping_block(seed: int, lexemes: Sequence[str]) -> str:
    """Return a random BML block of overlapping gestures and head gestures.

    Args:
        seed: seed of all random choices.
        lexemes: lexemes to choose gestures from.
    """
    rng = random.Random(seed)
    lines, stroke = [], 0.3
    for k in range(rng.randint(3, 5)):
        stroke += rng.uniform(0.3, 1.1)
        start, end = stroke - rng.uniform(0.15, 0.6), stroke + rng.uniform(0.2, 0.8)
        lines.append(
            f'<gesture id="g{k}" lexeme="{rng.choice(lexemes)}" mode="{rng.choice(HAND_MODES)}" '
            f'start="{start:.3f}" stroke="{stroke:.3f}" end="{end:.3f}"/>'
        )
        stroke = rng.choice((stroke, end))
    lines += [
        f'<head id="h{k}" lexeme="{rng.choice(("NOD", "SHAKE"))}" amount="{rng.random():.2f}" '
        f'start="{rng.uniform(0, 3):.3f}"/>'
        for k in range(rng.randint(0, 2))
    ]
    return CROWD_TEMPLATE.format("".join(lines))


def write_crammed_block(seed: int, lexemes: Sequence[str], count: int) -> str:
    """Return a BML block of many gestures and nods within 10 s.

    No sensible author would write such a block; it bounds the cost of planning.

    Args:
        seed: seed of all random choices.
        lexemes: lexemes to choose gestures from.
        count: number of gestures, and of nods.
    """
    rng = random.Random(seed)
    lines = [
        f'<gesture id="g{k}" lexeme="{rng.choice(lexemes)}" stroke="{rng.uniform(0, 10):.2f}"/>'
        f'<head id="h{k}" lexeme="NOD" amount="0.5" start="{rng.uniform(0, 10):.2f}"/>'
        for k in range(count)
    ]
    return CROWD_TEMPLATE.format("".join(lines))


def write_rapid_head_block(seed: int) -> str:
    """Return a block with one head gesture, too short for its strokes.

    The three to six strokes do not fit into its time.

    Args:
        seed: seed of all random choices.
    """
    rng = random.Random(seed)
    count, amount = rng.randint(3, 6), rng.uniform(0.6, 1.0)
    lexeme = rng.choice(("NOD", "SHAKE"))
    end = 0.5 + (0.34 if lexeme == "NOD" else 0.5) * (count + 0.8) * amount**0.5 * rng.uniform(0.85, 1.0)
    line = f'<head id="h" lexeme="{lexeme}" amount="{amount:.2f}" repetition="{count}" start="0.5" end="{end:.3f}"/>'
    return CROWD_TEMPLATE.format(line)


def find_corpus() -> Path | None:
    """Return the corpus folder: KINESIC_CORPUS or `../shared/corpus`.

    The result is None if that folder does not exist.
    """
    path = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
    return path if path.is_dir() else None


def plan_corpus(folder: Path, setup: Setup, count: int) -> tuple[Plan, ...]:
    """Plan up to `count` corpus documents with strokes, in seeded random order.

    Documents with errors, without strokes or longer than `MAX_BLOCK_DURATION` are skipped.

    Args:
        folder: folder of the corpus.
        setup: robot, style and options.
        count: maximum number of plans.
    """
    files = documents((folder,))
    random.Random(CORPUS_SEED).shuffle(files)
    plans: list[Plan] = []
    for file in files:
        try:
            block_plan = plan(file.read_bytes(), setup, source=str(file))
        except BmlError:
            continue
        if block_plan.duration <= MAX_BLOCK_DURATION and any(sync.is_stroke for sync in block_plan.syncs):
            plans.append(block_plan)
        if len(plans) == count:
            break
    return tuple(plans)

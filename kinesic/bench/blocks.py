"""Blocks that benches perform: a passage, crowds of gestures that no servo can follow, and documents of a corpus.

The passage takes about five seconds, moves both hands, head and torso and is perturbed at each repetition; a crowd is
the same for the same seed, and so is the choice of documents. Others wrote these; they are not part of the project.
"""

import os
import random
from collections.abc import Sequence
from pathlib import Path

from kinesic.bml.block import BmlError
from kinesic.controller.perform import plan
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.report.batch import documents

PASSAGE = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="passage">
  <gesture id="g1" lexeme="offer" mode="BOTH_HANDS" start="{0:.3f}" stroke="{1:.3f}" end="{2:.3f}"/>
  <gesture id="g2" lexeme="beat" mode="RIGHT_HAND" stroke="{3:.3f}"/>
  <gesture id="g3" lexeme="large" mode="BOTH_HANDS" stroke="{4:.3f}" end="{5:.3f}"/>
  <head id="h1" lexeme="NOD" amount="0.6" start="{6:.3f}"/>
  <head id="h2" lexeme="NOD" amount="0.4" repetition="2" start="{7:.3f}"/>
  <gaze id="z1" target="left" start="{8:.3f}" end="{9:.3f}"/>
</bml>
"""
TIMES = (0.2, 1.0, 2.2, 2.7, 3.9, 5.0, 0.4, 2.0, 3.4, 4.7)  # [s]
ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="crowd">{}</bml>'
MODES = ("LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS")
SEED = 50
LONGEST = 60.0  # [s] of a block


def passage_text(repetition: int) -> str:
    """Writes the block with all times a little later at each repetition, so that nothing can be remembered."""
    return PASSAGE.format(*(time + 0.003 * (repetition % 17) for time in TIMES))


def crowd(seed: int, lexemes: Sequence[str]) -> str:
    """Writes three to five gestures that overlap or follow at once, and up to two nods or shakes of the head.

    Args:
        seed: of all choices.
        lexemes: of gestures.
    """
    chance = random.Random(seed)
    lines, stroke = [], 0.3
    for k in range(chance.randint(3, 5)):
        stroke += chance.uniform(0.3, 1.1)
        start, end = stroke - chance.uniform(0.15, 0.6), stroke + chance.uniform(0.2, 0.8)
        lines.append(
            f'<gesture id="g{k}" lexeme="{chance.choice(lexemes)}" mode="{chance.choice(MODES)}" '
            f'start="{start:.3f}" stroke="{stroke:.3f}" end="{end:.3f}"/>'
        )
        stroke = chance.choice((stroke, end))
    lines += [
        f'<head id="h{k}" lexeme="{chance.choice(("NOD", "SHAKE"))}" amount="{chance.random():.2f}" '
        f'start="{chance.uniform(0, 3):.3f}"/>'
        for k in range(chance.randint(0, 2))
    ]
    return ROOT.format("".join(lines))


def throng(seed: int, lexemes: Sequence[str], count: int) -> str:
    """Writes so many gestures and as many nods at any times within ten seconds, as nobody would who means well.

    Args:
        seed: of all choices.
        lexemes: of gestures.
        count: of each.
    """
    chance = random.Random(seed)
    lines = [
        f'<gesture id="g{k}" lexeme="{chance.choice(lexemes)}" stroke="{chance.uniform(0, 10):.2f}"/>'
        f'<head id="h{k}" lexeme="NOD" amount="0.5" start="{chance.uniform(0, 10):.2f}"/>'
        for k in range(count)
    ]
    return ROOT.format("".join(lines))


def rhythm(seed: int) -> str:
    """Writes a nod or a shake of the head with three to six strokes, in less time than they take.

    Args:
        seed: of all choices.
    """
    chance = random.Random(seed)
    count, amount = chance.randint(3, 6), chance.uniform(0.6, 1.0)
    lexeme = chance.choice(("NOD", "SHAKE"))
    end = 0.5 + (0.34 if lexeme == "NOD" else 0.5) * (count + 0.8) * amount**0.5 * chance.uniform(0.85, 1.0)
    line = f'<head id="h" lexeme="{lexeme}" amount="{amount:.2f}" repetition="{count}" start="0.5" end="{end:.3f}"/>'
    return ROOT.format(line)


def corpus_folder() -> Path | None:
    """Finds KINESIC_CORPUS, or `shared/corpus` beside the project; None where there is none."""
    path = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
    return path if path.is_dir() else None


def plan_corpus(where: Path, known: Setup, count: int) -> tuple[Plan, ...]:
    """Plans the first so many documents, in a seeded order, that perform a stroke.

    Args:
        where: the folder.
        known: what planning needs.
        count: of documents.
    """
    files = documents((where,))
    random.Random(SEED).shuffle(files)
    chosen: list[Plan] = []
    for file in files:
        try:
            found = plan(file.read_bytes(), known, source=str(file))
        except BmlError:
            continue
        if found.duration <= LONGEST and any(sync.is_stroke for sync in found.syncs):
            chosen.append(found)
        if len(chosen) == count:
            break
    return tuple(chosen)

"""Blocks that benches perform: a passage of about five seconds, and crowds of gestures that no servo can follow.

The passage moves both hands, head and torso and is perturbed at each repetition; a crowd is the same for the same
seed.
"""

import random
from collections.abc import Sequence

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


def passage_text(repetition: int) -> str:
    """The block with all times a little later at each repetition, so that nothing can be remembered."""
    return PASSAGE.format(*(time + 0.003 * (repetition % 17) for time in TIMES))


def crowd(seed: int, lexemes: Sequence[str]) -> str:
    """Three to five gestures that overlap or follow at once, and up to two nods or shakes of the head.

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

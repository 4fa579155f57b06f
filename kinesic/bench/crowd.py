"""Blocks whose gestures are asked for faster than servos can follow, the same for the same seed."""

import random
from collections.abc import Sequence

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="crowd">{}</bml>'
MODES = ("LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS")


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

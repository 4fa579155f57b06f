"""Playing blocks of a gesture and a nod, made by hand."""

from dataclasses import replace

import numpy as np

from .small_blocks import HINGE_COUNT, small_block, small_motion

TIMES = {"g": {"start": 0.0, "stroke": 1.0, "end": 3.0}, "n": {"start": 0.5, "end": 4.0}}
BEHAVIOURS = '<gesture id="g" lexeme="BEAT"/><head id="n" lexeme="NOD"/>'
NECK = 3  # index of a neck hinge whose rest angle is 0


def layer(*hinges: int, value: float = 0.1) -> np.ndarray:
    """Return control points that move some hinges."""
    controls = np.zeros((400, HINGE_COUNT))
    controls[50:60, list(hinges)] = value
    return controls


def playing(*hinges: int, occupancy=(), **options):
    """Return a block that begins at 10 s."""
    block = small_block("b", TIMES, inside=BEHAVIOURS, motion=small_motion(), zero=10.0, run=3, **options)
    merged = replace(block.merged, layer=replace(block.merged.layer, controls=layer(*hinges)), occupancy=occupancy)
    return replace(block, merged=merged)

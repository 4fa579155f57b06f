"""Tests of the memory that planning retains between documents."""

import gc
import tracemalloc
from random import Random

import pytest

from kinesic.session.plan import plan
from kinesic.session.setup import set_up

# gesture with a given stroke time [s], and a nod
BLOCK_TEMPLATE = (
    '<bml id="b"><gesture id="g" lexeme="BEAT" start="0.1" stroke="{:.2f}"/><head id="h" lexeme="NOD"/></bml>'
)
WARM_UP_BLOCKS = 140  # number of blocks that fill the caches
MEASURED_BLOCKS = 60  # number of further blocks until the memory is measured again
MAX_RETAINED_SIZE = 100_000  # [bytes] by which the caches may still grow


@pytest.mark.soak
def test_planning_memory_grows_by_less_than_100_kb_after_140_documents() -> None:
    """Plan further documents with full caches, and measure the allocated memory."""
    setup, chance = set_up(), Random(4)

    def retained_size(blocks: int) -> int:
        for _ in range(blocks):
            plan(BLOCK_TEMPLATE.format(chance.uniform(0.8, 2.0)), setup)
        gc.collect()
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        before, after = retained_size(WARM_UP_BLOCKS), retained_size(MEASURED_BLOCKS)
    finally:
        tracemalloc.stop()
    assert after - before < MAX_RETAINED_SIZE

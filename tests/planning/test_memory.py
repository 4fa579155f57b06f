"""Memory that planning retains between documents."""

import gc
import tracemalloc
from random import Random

import pytest

from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BLOCK = '<bml id="b"><gesture id="g" lexeme="BEAT" start="0.1" stroke="{:.2f}"/><head id="h" lexeme="NOD"/></bml>'
WARM_UP_BLOCKS, MEASURED_BLOCKS = 140, 60
MAX_RETAINED_SIZE = 100_000  # [bytes] by which the caches may still grow


@pytest.mark.soak
def test_planning_memory_grows_by_less_than_100_kb_after_140_documents() -> None:
    """A long-lived planner must not collect the objects of documents that are over."""
    setup, chance = set_up(), Random(4)

    def retained_size(blocks: int) -> int:
        for _ in range(blocks):
            plan(BLOCK.format(chance.uniform(0.8, 2.0)), setup)
        gc.collect()
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        before, after = retained_size(WARM_UP_BLOCKS), retained_size(MEASURED_BLOCKS)
    finally:
        tracemalloc.stop()
    assert after - before < MAX_RETAINED_SIZE

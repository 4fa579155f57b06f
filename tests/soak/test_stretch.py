"""Fifty blocks with shifted key times, compared with a nonlinear program."""

import pytest

from kinesic.bench.blocks import write_overlapping_block
from kinesic.bench.plan import compare_with_optimum, count_violations, count_wrong_warnings
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BLOCK_COUNT = 50  # number of blocks whose key times must change

pytestmark = pytest.mark.soak


def test_time_shifts_of_overlapping_blocks_are_close_to_the_optimum():
    known = set_up()
    lexemes = [form.id for form in known.lexicon.forms]
    plans = [plan(write_overlapping_block(seed, lexemes), known) for seed in range(BLOCK_COUNT)]
    assert [count_violations(item) for item in plans] == [0] * BLOCK_COUNT
    assert [count_wrong_warnings(item) for item in plans] == [(0, 0)] * BLOCK_COUNT
    metrics = {metric.name: metric for metric in compare_with_optimum(plans)}
    assert metrics["plan.stretch_blocks"].value >= 0.9 * BLOCK_COUNT
    assert metrics["plan.stretch"].ok, metrics

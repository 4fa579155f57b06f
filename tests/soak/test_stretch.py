"""Fifty blocks whose times must move, against the nonlinear program (`make soak`)."""

import pytest

from kinesic.bench.blocks import crowd
from kinesic.bench.plan import count_wrong_warnings, stretch, violations
from kinesic.controller.perform import plan, set_up

BLOCKS = 50

pytestmark = pytest.mark.soak


def test_times_move_hardly_more_than_they_must():
    known = set_up()
    lexemes = [form.id for form in known.lexicon.forms]
    plans = [plan(crowd(seed, lexemes), known) for seed in range(BLOCKS)]
    assert [violations(found) for found in plans] == [0] * BLOCKS
    assert [count_wrong_warnings(found) for found in plans] == [(0, 0)] * BLOCKS
    figures = {figure.name: figure for figure in stretch(plans)}
    assert figures["plan.stretch_blocks"].value >= 0.9 * BLOCKS
    assert figures["plan.stretch"].ok, figures

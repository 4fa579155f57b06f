"""Blocks that ask for more than servos can: no limit is exceeded at 1 kHz, and every shift is said in advance."""

import random
from dataclasses import replace

import pytest

from kinesic.bench.blocks import crowd
from kinesic.bench.plan import count_wrong_warnings, violations
from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.style.style import RANGES, Expressivity, Style


@pytest.fixture(scope="module")
def known():
    return set_up()


@pytest.mark.parametrize("seed", [20, 25])
def test_crowded_blocks_keep_limits_and_say_what_moves(seed, known):
    chance = random.Random(seed)
    manner = Expressivity(**{name: chance.choice(ends) for name, ends in RANGES.items()})
    lexemes = [form.id for form in known.lexicon.forms]
    planned = plan(crowd(seed, lexemes), replace(known, style=Style.uniform(manner)))
    assert violations(planned) == 0
    assert count_wrong_warnings(planned) == (0, 0)
    assert any(abs(sync.planned - sync.asked) > 0.01 for sync in planned.syncs)

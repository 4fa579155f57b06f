"""Overloaded blocks exceed no limit, and every shift is reported."""

import random
from dataclasses import replace

import pytest

from kinesic.bench.blocks import write_overlapping_block
from kinesic.bench.plan import count_violations, count_wrong_warnings
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, Expressivity, Style
from kinesic.session.plan import plan
from kinesic.session.setup import set_up


@pytest.fixture(scope="module")
def known():
    return set_up()


@pytest.mark.parametrize("seed", [20, pytest.param(25, marks=pytest.mark.soak)])
def test_overloaded_blocks_keep_limits_and_report_shifts(seed, known):
    chance = random.Random(seed)
    manner = Expressivity(**{name: chance.choice(ends) for name, ends in EXPRESSIVITY_RANGES.items()})
    lexemes = [form.id for form in known.lexicon.forms]
    planned = plan(write_overlapping_block(seed, lexemes), replace(known, style=Style.uniform(manner)))
    assert count_violations(planned) == 0
    assert count_wrong_warnings(planned) == (0, 0)
    assert any(abs(sync.planned - sync.requested) > 0.01 for sync in planned.syncs)

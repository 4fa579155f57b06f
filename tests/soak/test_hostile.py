"""Hostile documents, each planned or refused within 10 s and 500 MB."""

import pytest

from kinesic.bench.plan.hostile import HOSTILE_DOCUMENTS, MAX_CPU_TIME, MAX_MEMORY, measure_hostile_plan

pytestmark = pytest.mark.soak


@pytest.mark.parametrize("name", HOSTILE_DOCUMENTS)
def test_hostile_documents_are_planned_within_time_and_memory_limits(name):
    cost = measure_hostile_plan(name)
    assert cost.cpu <= MAX_CPU_TIME, cost
    assert cost.memory <= MAX_MEMORY, cost

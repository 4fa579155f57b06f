"""Every hostile document is planned or refused in 10 s of CPU and 500 MB (`make soak`)."""

import pytest

from kinesic.bench.plan.hostile import CPU, DOCUMENTS, MEMORY, measure_plan

pytestmark = pytest.mark.soak


@pytest.mark.parametrize("name", DOCUMENTS)
def test_planned_in_time_and_memory(name):
    cost = measure_plan(name)
    assert cost.cpu <= CPU, cost
    assert cost.memory <= MEMORY, cost

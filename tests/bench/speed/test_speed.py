import pytest

from kinesic.bench import speed
from kinesic.bench.speed import dry_runs, plans, starting
from kinesic.controller.closed_loop import KERNEL


@pytest.fixture(scope="module")
def figures():
    with pytest.MonkeyPatch.context() as patch:
        for module, count in ((dry_runs, 3), (plans, 1), (starting, 1)):
            patch.setattr(module, "REPETITIONS", count)
        patch.setattr(dry_runs, "BLOCKS", 1)
        patch.setattr(dry_runs, "GROUP", 4)
        patch.setattr(dry_runs, "GROUPS", 2)
        patch.setattr(plans, "WORST_CROWD", 3)
        return {figure.name: figure for figure in speed.bench()}


def test_every_stage_is_there_and_the_loop_is_near_what_physics_take(figures):
    stages = [name for name in figures if name.startswith("speed.stage_")]
    assert len(stages) == 6
    assert all(figures[name].value > 0 for name in stages)
    assert all(figures[name].value > 0 for name in ("speed.plan_asked", "speed.plan_moved", "speed.plan_condition"))


@pytest.mark.skipif(KERNEL != "compiled", reason="no compiled kernel")
def test_a_dry_run_is_near_its_physics(figures):
    # 0.6 and 0.66, and half of that where memory is slow, as when a machine has filled it with files
    assert figures["speed.dry_run_of_bare"].value > 0.2
    assert figures["speed.dry_run_both_of_bare"].value > 0.2
    assert figures["speed.bare"].value > figures["speed.dry_run"].value


def test_a_variant_of_servos_takes_less_than_a_dry_run(figures):
    bare = 1000 * 5.3 / figures["speed.bare"].value  # [ms]
    assert 0.3 * bare < figures["speed.variant"].value < 2.5 * bare
    assert figures["speed.variant"].goal == 20.0


def test_planning_needs_no_more_memory_than_it_promises(figures):
    assert figures["speed.planner_memory"].ok
    assert figures["speed.ready_memory"].value < figures["speed.planner_memory"].value
    assert figures["speed.ready"].value < figures["speed.beat"].value

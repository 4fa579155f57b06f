import pytest

from kinesic.bench import speed
from kinesic.bench.speed import dry_runs, plans, starting


@pytest.fixture(scope="module")
def metrics():
    with pytest.MonkeyPatch.context() as patch:
        for module, name, count in (
            (dry_runs, "RUN_REPETITIONS", 3),
            (plans, "PLAN_REPETITIONS", 1),
            (starting, "RUN_REPETITIONS", 1),
        ):
            patch.setattr(module, name, count)
        patch.setattr(dry_runs, "PASSAGE_COUNT", 1)
        patch.setattr(dry_runs, "GROUP_SIZE", 4)
        patch.setattr(dry_runs, "VARIANT_GROUPS", 2)
        patch.setattr(plans, "WORST_SEED", 3)
        return {metric.name: metric for metric in speed.bench()}


@pytest.fixture(scope="module")
def starts():
    """Return metrics of program starts without the other speed measurements."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(starting, "RUN_REPETITIONS", 1)
        return {metric.name: metric for metric in starting.bench()}


@pytest.mark.soak
def test_every_dry_run_and_planning_stage_is_timed(metrics):
    stages = [name for name in metrics if name.startswith("speed.stage_")]
    assert len(stages) == 6
    assert all(metrics[name].value > 0 for name in stages)
    assert all(metrics[name].value > 0 for name in ("speed.plan_asked", "speed.plan_moved", "speed.plan_condition"))


@pytest.mark.soak
def test_dry_run_speed_is_over_a_fifth_of_bare_physics_speed(metrics):
    # usually 0.6 and 0.66, but half of that on machines with slow or full memory
    assert metrics["speed.dry_run_of_bare"].value > 0.2
    assert metrics["speed.dry_run_both_of_bare"].value > 0.2
    assert metrics["speed.bare"].value > metrics["speed.dry_run"].value


@pytest.mark.soak
def test_dry_run_with_other_servo_parameters_takes_less_than_ten_times_bare_physics(metrics):
    bare = 1000 * 5.3 / metrics["speed.bare"].value  # [ms]
    assert 0.1 * bare < metrics["speed.variant"].value < 10 * bare
    assert metrics["speed.variant"].goal == 20.0


def test_planning_memory_stays_below_its_goal(starts):
    assert starts["speed.planner_memory"].ok
    assert starts["speed.ready_memory"].value < starts["speed.planner_memory"].value


def test_program_start_and_first_planned_gesture_take_a_positive_time(starts):
    # no more is asserted: each time is measured in a process of its own, and the difference is below the noise
    assert starts["speed.ready"].value > 0
    assert starts["speed.beat"].value > 0

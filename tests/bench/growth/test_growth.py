import gc
import tracemalloc

import numpy as np
import pytest

from kinesic.bench.growth import DocumentCost, bench, cost_by_length, draw, fit_exponents, write_gesture_document
from kinesic.bench.growth.robots import make_robots
from kinesic.body import command
from kinesic.controller import closed_loop
from kinesic.controller.dry_run import dry_run
from kinesic.metrics import arrival, reference, tracking_delay
from kinesic.motion import piecewise
from kinesic.report.checks import checks
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

FLOAT_BYTES = 8  # [bytes]


def test_exponents_of_cost_growth_are_fitted_above_a_minimum_document_length():
    costs = [DocumentCost(size, 2.0 * size**1.5, 3.0 * size, 7.0, 5.0 * size**0.5) for size in (10.0, 30.0, 90.0)]
    short = DocumentCost(1.0, 50.0, 50.0, 50.0, 50.0)
    metrics = fit_exponents([short, *costs], min_size=10.0)
    assert metrics == pytest.approx({"plan": 1.5, "run": 1.0, "plan_memory": 0.0, "memory": 0.5}, abs=1e-12)


def test_growth_benchmark_divides_the_memory_of_a_long_document_by_that_of_a_shorter_one(monkeypatch):
    costs = (DocumentCost(60.0, 1.0, 2.0, 100.0, 150.0), DocumentCost(600.0, 10.0, 20.0, 130.0, 300.0))
    monkeypatch.setattr("kinesic.bench.growth.cost_by_length", lambda: costs)
    monkeypatch.setattr("kinesic.bench.growth.cost_by_joints", lambda: costs)
    metrics = {metric.name: metric for metric in bench()}
    assert metrics["growth.length.plan"].value == pytest.approx(1.0)
    smaller, larger = metrics["growth.length.plan_memory"], metrics["growth.length.memory"]
    assert (smaller.value, smaller.ok) == (1.3, True)
    assert (larger.value, larger.ok) == (2.0, False)


def test_growth_benchmark_robots_have_increasing_joint_counts():
    built = list(make_robots())
    counts = [len(robot.drives) for robot in built]
    assert counts == sorted(counts) == [8, 14, 16, 19, 22, 36, 58]
    assert len(built[-1].skeleton.couplings) == 0


def test_growth_benchmark_document_has_a_gesture_every_two_seconds():
    assert write_gesture_document(1.0).count("<gesture") == 1
    assert write_gesture_document(60.0).count("<gesture") == 30


@pytest.mark.soak
def test_document_cost_contains_time_and_memory_of_planning_and_running(monkeypatch):
    monkeypatch.setattr("kinesic.bench.growth.DOCUMENT_LENGTHS", (2.0,))
    (cost,) = cost_by_length.__wrapped__()
    assert cost.size == 2.0
    assert min(cost.planning, cost.running) > 0.0
    assert 30.0 < cost.planning_memory <= cost.memory


@pytest.mark.soak
def test_dry_run_needs_little_more_memory_than_its_result(monkeypatch):
    monkeypatch.setattr(tracking_delay, "VELOCITIES_PER_WINDOW", 4096)
    for module, name in (
        (closed_loop, "COMMANDS_PER_WINDOW"),
        (command, "COMMANDS_PER_WINDOW"),
        (reference, "MAX_CACHED_COMMANDS"),
        (reference, "COMMANDS_PER_WINDOW"),
        (arrival, "POSTURES_PER_WINDOW"),
        (piecewise, "TIMES_PER_EVALUATION"),
    ):
        monkeypatch.setattr(module, name, 256)
    setup, rows, peaks = set_up(), [], []
    for length in (6.0, 10.0, 20.0):  # the first run imports what planning needs
        planned = plan(write_gesture_document(length), setup)
        run, memory = trace_memory(lambda planned=planned: dry_run(planned, watch=False))
        peaks.append((memory, trace_memory(lambda run=run: checks(run))[1]))
        rows.append(run.measured.angles.size)
    (performed, checked), count = np.diff(peaks[1:], axis=0)[0] / FLOAT_BYTES, rows[2] - rows[1]
    assert performed < 5 * count  # angles, velocities, both goals as ticks and the plan's duties take three and a half
    assert checked < 1.6 * count  # joint motion, its errors, and paths


def trace_memory(work):
    """Return a function's result and its peak memory [bytes]."""
    gc.collect()
    tracemalloc.start()
    try:
        return work(), tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_growth_of_planning_cost_with_document_length_is_plotted_as_png(tmp_path, monkeypatch):
    costs = tuple(DocumentCost(size, size, size, size, size) for size in np.array([10.0, 100.0]))
    monkeypatch.setattr("kinesic.bench.growth.cost_by_length", lambda: costs)
    monkeypatch.setattr("kinesic.bench.growth.cost_by_joints", lambda: costs)
    (path,) = draw(tmp_path)
    assert path.read_bytes().startswith(b"\x89PNG")

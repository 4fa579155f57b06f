import gc
import tracemalloc

import numpy as np
import pytest

from kinesic.bench.growth import Cost, bench, by_length, document, draw, exponents
from kinesic.bench.growth.robots import robots
from kinesic.body import command
from kinesic.controller import arrival, closed_loop, performance, tracking_delay
from kinesic.controller.perform import dry_run, plan, set_up
from kinesic.motion import piecewise
from kinesic.report.checks import checks

NUMBER = 8  # [bytes]


def test_exponents_are_those_of_a_power_law_from_a_size_on():
    costs = [Cost(size, 2.0 * size**1.5, 3.0 * size, 7.0, 5.0 * size**0.5) for size in (10.0, 30.0, 90.0)]
    short = Cost(1.0, 50.0, 50.0, 50.0, 50.0)
    found = exponents([short, *costs], least=10.0)
    assert found == pytest.approx({"plan": 1.5, "run": 1.0, "plan_memory": 0.0, "memory": 0.5}, abs=1e-12)


def test_memory_of_a_long_document_is_told_beside_that_of_a_shorter_one(monkeypatch):
    costs = (Cost(60.0, 1.0, 2.0, 100.0, 150.0), Cost(600.0, 10.0, 20.0, 130.0, 300.0))
    monkeypatch.setattr("kinesic.bench.growth.by_length", lambda: costs)
    monkeypatch.setattr("kinesic.bench.growth.by_hinges", lambda: costs)
    found = {figure.name: figure for figure in bench()}
    assert found["growth.length.plan"].value == pytest.approx(1.0)
    flat, grown = found["growth.length.plan_memory"], found["growth.length.memory"]
    assert (flat.value, flat.ok) == (1.3, True)
    assert (grown.value, grown.ok) == (2.0, False)


def test_robots_have_more_and_more_hinges_and_the_last_one_has_no_couplings():
    made = list(robots())
    counts = [len(robot.drives) for robot in made]
    assert counts == sorted(counts) == [8, 14, 16, 19, 22, 36, 58]
    assert len(made[-1].skeleton.couplings) == 0


def test_a_document_has_a_gesture_every_two_seconds():
    assert document(1.0).count("<gesture") == 1
    assert document(60.0).count("<gesture") == 30


def test_what_a_document_takes_is_measured_in_a_process_of_its_own(monkeypatch):
    monkeypatch.setattr("kinesic.bench.growth.LENGTHS", (2.0,))
    (cost,) = by_length.__wrapped__()
    assert cost.size == 2.0
    assert min(cost.planning, cost.running) > 0.0
    assert 30.0 < cost.planning_memory <= cost.memory


@pytest.mark.skipif(closed_loop.KERNEL != "compiled", reason="Python performs all in one window")
def test_a_dry_run_takes_little_more_than_what_it_measures(monkeypatch):
    monkeypatch.setattr(tracking_delay, "SPEEDS_PER_WINDOW", 4096)
    for module, name in (
        (closed_loop, "COMMANDS_PER_WINDOW"),
        (command, "COMMANDS_PER_WINDOW"),
        (performance, "MOST_KEPT"),
        (performance, "COMMANDS_PER_WINDOW"),
        (arrival, "POSTURES_PER_WINDOW"),
        (piecewise, "TIMES_PER_EVALUATION"),
    ):
        monkeypatch.setattr(module, name, 256)
    known, rows, peaks = set_up(), [], []
    for length in (6.0, 10.0, 20.0):  # the first imports what it needs
        planned = plan(document(length), known)
        run, taken = traced(lambda planned=planned: dry_run(planned, watch=False))
        peaks.append((taken, traced(lambda run=run: checks(run))[1]))
        rows.append(run.measured.angles.size)
    (performed, judged), count = np.diff(peaks[1:], axis=0)[0] / NUMBER, rows[2] - rows[1]
    assert performed < 5 * count  # angles, speeds, both goals as ticks, and the plan's duties are three and a half
    assert judged < 1.6 * count  # what moves, its errors, and paths


def traced(work):
    """What some work gives, and the memory [bytes] that it took at most."""
    gc.collect()
    tracemalloc.start()
    try:
        return work(), tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_growth_is_drawn(tmp_path, monkeypatch):
    costs = tuple(Cost(size, size, size, size, size) for size in np.array([10.0, 100.0]))
    monkeypatch.setattr("kinesic.bench.growth.by_length", lambda: costs)
    monkeypatch.setattr("kinesic.bench.growth.by_hinges", lambda: costs)
    (path,) = draw(tmp_path)
    assert path.read_bytes().startswith(b"\x89PNG")

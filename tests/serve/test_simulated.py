"""Simulated time of control loops."""

from threading import Thread
from time import monotonic

from kinesic.serve import loop as loop_module
from kinesic.serve import messages

from .simulated import Simulation


def test_event_loop_of_another_thread_keeps_real_time_during_a_simulation(simulation: Simulation):
    before, results = simulation.time, []

    def use_clock() -> None:
        loop_module.sleep(0.0)
        results.extend([loop_module.monotonic(), messages.monotonic(), loop_module.wait([], 0.0)])

    other = Thread(target=use_clock)
    began = monotonic()
    other.start()
    other.join()
    assert simulation.time == before
    assert simulation.sleeps == 0
    assert all(began <= time <= monotonic() for time in results[:2])
    assert results[2] == []

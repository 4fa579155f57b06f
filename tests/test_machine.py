"""The look at the machine that comes before every test in real time."""

import numpy as np
import pytest

from .machine import FAILURES, Look, Watch, look
from .nudge import nudge, nudged_generator


@pytest.mark.parametrize(
    ("seen", "missing"),
    [
        (Look(0.001, 0.9, 0.002), ""),
        (Look(0.035, 0.9, 0.002), "it wakes 35 ms late (at most 20)"),
        (Look(0.001, 0.1, 0.002), "it gives 10 % of a core (at least 30)"),
        (Look(0.001, 0.9, 0.3), "a core needs 300 ms for what may take 40"),
    ],
)
def test_a_look_says_what_is_missing(seen: Look, missing: str):
    assert seen.complaint == missing


def test_a_short_disturbance_is_waited_for_and_a_good_look_counts_for_a_while(monkeypatch: pytest.MonkeyPatch):
    looks = [Look(0.1, 1.0, 0.002), Look(0.001, 1.0, 0.002)]
    monkeypatch.setattr(f"{Watch.__module__}.look", lambda: looks.pop(0))
    watch = Watch()
    assert watch.complaint() == ""
    assert watch.complaint() == ""  # nobody looks again: nothing is left to be seen
    assert looks == []


def test_a_machine_that_stays_slow_is_called_so(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(f"{Watch.__module__}.PATIENCE", 0.0)
    monkeypatch.setattr(f"{Watch.__module__}.look", lambda: Look(0.1, 1.0, 0.002))
    assert Watch().complaint() == "it wakes 100 ms late (at most 20)"


def test_a_machine_that_was_too_slow_before_is_not_waited_for_again(monkeypatch: pytest.MonkeyPatch):
    slow, looks = Look(0.1, 1.0, 0.002), []
    monkeypatch.setattr(f"{Watch.__module__}.PATIENCE", 0.1)
    monkeypatch.setattr(f"{Watch.__module__}.AGAIN", 0.0)
    monkeypatch.setattr(f"{Watch.__module__}.look", lambda: looks.append(slow) or slow)
    watch = Watch()
    assert watch.complaint()
    looks.clear()
    assert watch.complaint()
    assert len(looks) == 1


def test_a_failure_is_excused_where_a_core_was_missing_and_some_end_all_tries(monkeypatch: pytest.MonkeyPatch):
    shares = [0.9] + [0.2] * FAILURES
    monkeypatch.setattr(f"{Watch.__module__}.look", lambda loops=0: Look(0.001, shares.pop(0) if loops else 1.0, 0.002))
    watch = Watch()
    assert watch.excuse() == ""
    for _ in range(FAILURES):
        assert watch.complaint() == ""
        assert watch.excuse() == "it gives 20 % of a core (at least 50)"
    assert watch.complaint() == f"{FAILURES} tests had too little of a core"


def test_what_is_measured_is_finite_and_positive():
    seen = look()
    assert seen.lateness > 0.0
    assert 0.0 < seen.share <= 1.1
    assert 0.0 < seen.loops < 10.0


def test_nudged_inputs_are_a_few_last_bits_away_and_always_the_same():
    values = np.random.Generator(np.random.PCG64(1)).uniform(1.0, 2.0, 100)
    away = nudge(values, 7)
    assert (away != values).any()
    assert abs(away / values - 1.0).max() < 2e-15
    assert (nudge(values, 7) == away).all()
    drawn = nudged_generator(7)(np.random.PCG64(1)).uniform(1.0, 2.0, 100)
    assert (drawn == away).all()

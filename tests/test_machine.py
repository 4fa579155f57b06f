"""Check of the machine before realtime tests."""

import numpy as np
import pytest

from .machine import MAX_EXCUSED_FAILURES, Look, Watch, depends_on_time, look
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
def test_timing_check_of_the_machine_reports_late_wake_ups_and_missing_processor_time(seen: Look, missing: str):
    assert seen.complaint == missing


def test_timing_check_of_the_machine_is_repeated_after_a_disturbance_and_its_success_is_cached(
    monkeypatch: pytest.MonkeyPatch,
):
    looks = [Look(0.1, 1.0, 0.002), Look(0.001, 1.0, 0.002)]
    monkeypatch.setattr(f"{Watch.__module__}.look", lambda: looks.pop(0))
    watch = Watch()
    assert watch.complaint() == ""
    assert watch.complaint() == ""  # no further check is made
    assert looks == []


def test_timing_check_reports_how_late_a_machine_wakes_that_stays_too_slow(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(f"{Watch.__module__}.PATIENCE_TIME", 0.0)
    monkeypatch.setattr(f"{Watch.__module__}.look", lambda: Look(0.1, 1.0, 0.002))
    assert Watch().complaint() == "it wakes 100 ms late (at most 20)"


def test_second_timing_check_of_a_slow_machine_measures_only_once(monkeypatch: pytest.MonkeyPatch):
    slow, looks = Look(0.1, 1.0, 0.002), []
    monkeypatch.setattr(f"{Watch.__module__}.PATIENCE_TIME", 0.1)
    monkeypatch.setattr(f"{Watch.__module__}.REPEATED_PATIENCE_TIME", 0.0)
    monkeypatch.setattr(f"{Watch.__module__}.look", lambda: looks.append(slow) or slow)
    watch = Watch()
    assert watch.complaint()
    looks.clear()
    assert watch.complaint()
    assert len(looks) == 1


def test_test_failures_on_a_busy_processor_are_excused_only_a_limited_number_of_times(monkeypatch: pytest.MonkeyPatch):
    shares = [0.9] + [0.2] * MAX_EXCUSED_FAILURES
    monkeypatch.setattr(f"{Watch.__module__}.look", lambda loops=0: Look(0.001, shares.pop(0) if loops else 1.0, 0.002))
    watch = Watch()
    assert watch.excuse() == ""
    for _ in range(MAX_EXCUSED_FAILURES):
        assert watch.complaint() == ""
        assert watch.excuse() == "it gives 20 % of a core (at least 50)"
    assert watch.complaint() == f"{MAX_EXCUSED_FAILURES} tests had too little of a core"


def test_timing_measurements_of_the_machine_are_finite_and_positive():
    seen = look()
    assert seen.lateness > 0.0
    assert 0.0 < seen.share <= 1.1
    assert 0.0 < seen.loops < 10.0


def test_perturbed_test_inputs_differ_by_a_few_ulps_deterministically():
    values = np.random.Generator(np.random.PCG64(1)).uniform(1.0, 2.0, 100)
    away = nudge(values, 7)
    assert (away != values).any()
    assert abs(away / values - 1.0).max() < 2e-15
    assert (nudge(values, 7) == away).all()
    drawn = nudged_generator(7)(np.random.PCG64(1)).uniform(1.0, 2.0, 100)
    assert (drawn == away).all()


@pytest.mark.parametrize("wrong", [AttributeError, FileNotFoundError, NameError, TypeError])
def test_programming_errors_in_a_test_do_not_count_as_timing_failures(wrong: type[Exception]):
    with pytest.raises(wrong) as failure:
        raise wrong("setpoints")
    assert not depends_on_time(failure)


def test_unexpected_error_message_in_a_test_does_not_count_as_a_timing_failure():
    with pytest.raises(AssertionError) as failure, pytest.raises(ValueError, match="token"):
        raise ValueError("bytes")
    assert not depends_on_time(failure)


def test_timeout_error_in_a_test_counts_as_a_possible_timing_failure():
    with pytest.raises(TimeoutError) as failure:
        raise TimeoutError("no answer within 1 s")
    assert depends_on_time(failure)

"""Benchmark of hearing."""

import numpy as np
import pytest

from kinesic.bench import hearing
from kinesic.bench.hearing import HearingOutcome, barge_in_metrics, judge, sounds
from kinesic.bench.hearing.mixtures import make_mixtures
from kinesic.bench.hearing.sounds import make_cough, make_knock, make_music, make_noise, reverberate, with_level
from kinesic.bench.hearing.stopping import _first_rest
from kinesic.speech.espeak_pool import espeak_fault


def outcome(kind="turn", duck=0.1, turn=0.5, early=0):
    return HearingOutcome(kind, 6.0, duck, turn, early, 0.015)


def test_hearing_benchmark_counts_missed_early_and_false_turns():
    outcomes = [outcome(), outcome(turn=None), outcome(turn=-2.0), outcome(turn=0.6)]
    outcomes += [outcome("short", turn=None), outcome("music"), outcome("none", None, None, early=3)]
    values = {metric.name.removeprefix("hearing."): metric.value for metric in barge_in_metrics(outcomes, [0.2, 0.3])}
    assert values["missed"] == 50.0
    assert values["false"] == pytest.approx(200 / 3)  # music, and a turn before the person spoke
    assert (values["false_music"], values["false_short"], values["false_cough"]) == (100.0, 0.0, 0.0)
    assert values["sound_off_p95"] == pytest.approx(1000 * (0.1 + hearing.OUTPUT_DELAY))
    assert 0.6 + hearing.PLANNING_DELAY < values["arms_still_p95"] <= 0.9 + hearing.PLANNING_DELAY
    assert values["own_ducks"] == pytest.approx(3 / 7 * 10)
    assert values["ducked"] == 100.0
    assert values["cpu"] == pytest.approx(15.0)


def test_hearing_metrics_without_espeak_have_a_reason_instead_of_a_value(monkeypatch):
    monkeypatch.setattr(hearing, "espeak_fault", lambda: "no espeak")
    metrics = hearing.bench()
    assert {metric.why for metric in metrics} == {"no espeak"}
    measured = barge_in_metrics([outcome(), outcome("short")], [0.2])
    assert {metric.name for metric in metrics} == {metric.name for metric in measured}


def test_generated_coughs_knocks_music_and_noise_depend_only_on_their_seed_and_are_finite():
    for make in (make_cough, make_knock, make_music, lambda random: make_noise(random, 4000)):
        first, same, other = (make(np.random.default_rng(seed)) for seed in (1, 1, 2))
        np.testing.assert_array_equal(first, same)
        assert first.shape != other.shape or not np.array_equal(first, other)
        assert np.isfinite(first).all()
        loud = with_level(first, 0.1)
        audible = loud[np.abs(loud) > 0.03 * np.abs(loud).max()]
        assert np.sqrt(np.mean(audible**2)) == pytest.approx(0.1, rel=0.05)


def test_reverberation_begins_with_the_direct_sound_after_its_delay():
    wet = reverberate(np.array([1.0, 0.0, 0.0]), np.random.default_rng(1), delay=0.01)
    assert np.abs(wet[:160]).max() < 1e-9
    assert wet[160] == pytest.approx(1.0)
    assert np.abs(wet[4000:]).max() < np.abs(wet[200:1000]).max()


def test_measured_stop_time_of_the_arms_ignores_a_short_standstill():
    velocities = np.concatenate([np.ones(30), np.zeros(10), np.ones(5), np.zeros(60)])
    assert _first_rest(velocities) == pytest.approx(0.45)
    assert _first_rest(np.zeros(50)) == 0.0


def test_robot_yields_to_the_first_spoken_question_of_the_tuning_set(monkeypatch):
    if fault := espeak_fault():
        pytest.skip(fault)
    monkeypatch.setattr(sounds, "find_installation_fault", lambda: "quicker")
    sounds.say_as_robot.cache_clear()
    first = next(make_mixtures(1, 1))
    sounds.say_as_robot.cache_clear()
    result = judge(first)
    assert (first.kind, result.kind) == ("turn", "turn")
    assert result.turn is not None
    assert result.duck is not None
    assert 0.0 < result.duck < result.turn < 1.2

"""Ear that hears a person while the robot speaks."""

import numpy as np
import pytest

from kinesic.body.utterance import Script
from kinesic.controller.soundtrack import resample_sound
from kinesic.hearing.barge_in import BargeInDecision
from kinesic.hearing.ear import Ear
from kinesic.hearing.voice_activity import VOICE_RATE
from kinesic.speech.espeak import Espeak

from .test_echo import room_echo

QUESTION_START = 2.5  # [s] time at which the person begins
MAX_DUCK_DELAY = 0.25  # [s] largest time from the start of a person's voice until the robot's speech fades
MAX_YIELD_DELAY = 0.9  # [s] largest time from the start of a person's voice to the decision to yield


@pytest.fixture(scope="module")
def voices(espeak: Espeak) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return three utterances at 16 kHz.

    They are the robot's sentence, and a question and a short answer of another pitch.
    """
    robot = "The castle was built on a hill above the river, and for many years nobody lived there at all."

    def say(text: str, pitch: float) -> np.ndarray:
        sound = espeak.say(Script(text), pitch=pitch).sound
        assert sound is not None
        samples = resample_sound(sound, VOICE_RATE)
        loud = np.flatnonzero(np.abs(samples) > 0.03 * np.abs(samples).max())
        return samples[loud[0] : loud[-1]] * 0.3

    return say(robot, 1.0), say("wait, I have a question about that", 1.4), say("yeah", 1.4)


def changes(heard, played=None, *, rate=VOICE_RATE, size=320):
    ear, result = Ear(rate), []
    for k in range(0, len(heard), size):
        own = None if played is None else played[k : k + size]
        result += list(ear.hear(heard[k : k + size], own))
    return result


def with_event(robot, event):
    """Return microphone and playback signals; a person's sound starts at `QUESTION_START`."""
    heard = room_echo(robot) + np.random.default_rng(1).normal(0.0, 0.001, len(robot)).astype(np.float32)
    begin = round(QUESTION_START * VOICE_RATE)
    heard[begin : begin + len(event)] += event
    return heard, robot


def test_question_asked_while_the_robot_speaks_takes_the_turn(voices):
    robot, question, _ = voices
    late = [change for change in changes(*with_event(robot, question)) if change.time > QUESTION_START]
    assert [change.decision for change in late[:2]] == [BargeInDecision.DUCK, BargeInDecision.YIELD]
    duck, turn = (change.time - QUESTION_START for change in late[:2])
    assert 0.06 < duck < MAX_DUCK_DELAY
    assert duck < turn < MAX_YIELD_DELAY
    assert late[1].age == pytest.approx(turn, abs=0.15)


def test_short_answer_of_a_person_and_the_robots_own_voice_do_not_take_the_turn(voices):
    robot, _, short = voices
    for event in (short, short[:0]):
        assert BargeInDecision.YIELD not in [change.decision for change in changes(*with_event(robot, event))]


def test_robots_own_voice_is_mistaken_for_a_person_without_the_playback_signal(voices):
    heard, _ = with_event(voices[0], voices[2][:0])
    assert BargeInDecision.YIELD in [change.decision for change in changes(heard[: 2 * VOICE_RATE])]


def test_reactions_to_voices_do_not_depend_on_the_number_of_samples_per_call(voices):
    heard = np.concatenate([np.zeros(VOICE_RATE, np.float32), voices[1], np.zeros(VOICE_RATE, np.float32)])
    small, large = changes(heard, size=100), changes(heard, size=5000)
    assert small == large
    assert [change.decision for change in small] == [BargeInDecision.DUCK, BargeInDecision.YIELD, BargeInDecision.END]


def test_playback_and_microphone_of_different_lengths_are_refused():
    with pytest.raises(ValueError, match="10 samples played and 20 heard"):
        list(Ear().hear(np.zeros(20, np.float32), np.zeros(10, np.float32)))


def test_voices_are_heard_at_the_rate_of_the_microphone(voices):
    question = np.concatenate([np.zeros(VOICE_RATE, np.float32), voices[1], np.zeros(VOICE_RATE, np.float32)])
    usual, triple = changes(question), changes(np.repeat(question, 3), rate=3 * VOICE_RATE)
    assert [change.decision for change in triple] == [change.decision for change in usual]
    assert [change.time for change in triple] == pytest.approx([change.time for change in usual], abs=0.07)


def test_own_voice_is_recognised_at_the_rate_of_the_microphone(voices):
    heard, played = (np.repeat(sound, 3) for sound in with_event(voices[0], voices[2][:0]))
    found = changes(heard, played, rate=3 * VOICE_RATE)
    assert BargeInDecision.YIELD not in [change.decision for change in found]

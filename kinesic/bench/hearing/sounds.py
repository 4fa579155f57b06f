"""Seeded sounds of a room: voices, coughs, knocks, music, noise and reverberation."""

from functools import cache
from itertools import pairwise

import numpy as np
from numpy.random import Generator

from kinesic.body.arrays import Floats
from kinesic.body.utterance import Samples, Script, Sound
from kinesic.controller.soundtrack import resample_sound
from kinesic.hearing.voice_activity import VOICE_RATE
from kinesic.speech.espeak import Espeak
from kinesic.speech.hibari.model import find_installation_fault
from kinesic.speech.voice import voice

SILENCE_RATIO = 0.03  # fraction of a sound's peak below which its start and end count as silence
SCALE_SEMITONES = (0, 2, 4, 5, 7, 9, 11, 12)  # [semitones] notes of the music: a major scale
REVERBERATION_GAIN = 0.06  # amplitude of the reverberation, relative to the direct sound
REVERBERATION_TIMES = (0.15, 0.4)  # [s] range of the time in which the reverberation falls by 60 dB


@cache
def say(text: str, language: str, rate: float, pitch: float) -> Samples:
    """Return a text spoken in a person's voice, without surrounding silence."""
    return _trimmed(Espeak().say(Script(text, language=language), rate=rate, pitch=pitch).sound)


@cache
def say_as_robot(text: str) -> Samples:
    """Return a text spoken in the robot's voice, without surrounding silence.

    The voice is hibari if it is installed, else espeak.
    """
    robot = voice("espeak" if find_installation_fault() else "hibari")
    return _trimmed(robot.say(Script(text)).sound)


def _trimmed(sound: Sound | None) -> Samples:
    if sound is None:
        raise RuntimeError("the voice is silent")
    samples = resample_sound(sound, VOICE_RATE)
    loud = np.flatnonzero(np.abs(samples) > SILENCE_RATIO * np.abs(samples).max())
    return samples[loud[0] : loud[-1] + 1]


def with_level(sound: Floats | Samples, level: float) -> Floats:
    """Scale a sound to an RMS of `level` in its audible part."""
    audible = sound[np.abs(sound) > SILENCE_RATIO * np.abs(sound).max()]
    return np.asarray(sound * (level / np.sqrt(np.mean(audible**2))))


def make_cough(random: Generator) -> Floats:
    """Return a cough: one or two noise bursts with a hoarse tail."""
    parts = []
    for _ in range(random.integers(1, 3)):
        time = np.arange(round(random.uniform(0.12, 0.3) * VOICE_RATE)) / VOICE_RATE
        envelope = np.minimum(time / 0.01, 1.0) * np.exp(-time / random.uniform(0.05, 0.12))
        noise = _band(random.normal(size=len(time)), 300.0, 5000.0)
        hoarse = sum(np.sin(2 * np.pi * k * random.uniform(90.0, 180.0) * time) / k for k in range(1, 8))
        parts += [envelope * (noise / np.abs(noise).max() + 0.15 * hoarse), _silence(random, 0.05, 0.2)]
    return np.concatenate(parts)


def make_knock(random: Generator) -> Floats:
    """Return the sound of one to three knocks on wood."""
    parts = []
    for _ in range(random.integers(1, 4)):
        time = np.arange(round(0.15 * VOICE_RATE)) / VOICE_RATE
        tone = np.sin(2 * np.pi * random.uniform(120.0, 500.0) * time) * np.exp(-time / 0.03)
        click = 0.5 * random.normal(size=len(time)) * np.exp(-time / 0.008)
        parts += [tone + click, _silence(random, 0.05, 0.25)]
    return np.concatenate(parts)


def make_music(random: Generator) -> Floats:
    """Return two to four seconds of music: chords with overtones."""
    duration, beat, root = random.uniform(2.0, 4.0), random.uniform(0.18, 0.5), random.uniform(130.0, 330.0)
    begins = np.append(np.cumsum(random.choice([0.0, 1.0, 1.0, 2.0], size=40)) * beat, duration)
    music = np.zeros(round(duration * VOICE_RATE))
    for begin, end in pairwise(np.unique(np.minimum(begins, duration))):
        first, last = round(begin * VOICE_RATE), round(end * VOICE_RATE)
        time = np.arange(last - first) / VOICE_RATE
        for semitone in random.choice(SCALE_SEMITONES, size=random.integers(1, 4), replace=False):
            pitch, fall, decay = root * 2 ** (semitone / 12), random.uniform(0.9, 1.6), random.uniform(0.2, 0.8)
            overtones = sum(np.sin(2 * np.pi * k * pitch * time) / k**fall for k in range(1, 9))
            music[first:last] += np.minimum(time / 0.01, 1.0) * np.exp(-time / decay) * overtones
    return music


def make_noise(random: Generator, count: int) -> Floats:
    """Return pink noise (count,) with a root mean square of 1."""
    spectrum = np.fft.rfft(random.normal(size=count))
    spectrum[1:] /= np.sqrt(np.arange(1, len(spectrum)))
    spectrum[0] = 0.0
    noise = np.fft.irfft(spectrum, count)
    return np.asarray(noise / np.std(noise))


def reverberate(sound: Floats | Samples, random: Generator, delay: float = 0.0) -> Floats:
    """Add the reverberation of a random room, and a delay [s]."""
    time = np.arange(round(0.3 * VOICE_RATE)) / VOICE_RATE
    path = (
        REVERBERATION_GAIN * random.normal(size=len(time)) * np.exp(-6.9 * time / random.uniform(*REVERBERATION_TIMES))
    )
    path[: round(0.002 * VOICE_RATE)] = 0.0
    path[0] = 1.0
    path = np.concatenate([np.zeros(round(delay * VOICE_RATE)), path])
    size = 1 << (len(sound) + len(path) - 1).bit_length()
    return np.asarray(np.fft.irfft(np.fft.rfft(sound, size) * np.fft.rfft(path, size), size)[: len(sound) + len(path)])


def _band(sound: Floats, low: float, high: float) -> Floats:
    """Filter a sound to the frequencies between two bounds [Hz]."""
    spectrum, frequencies = np.fft.rfft(sound), np.fft.rfftfreq(len(sound), 1.0 / VOICE_RATE)
    spectrum[(frequencies < low) | (frequencies > high)] = 0.0
    return np.asarray(np.fft.irfft(spectrum, len(sound)))


def _silence(random: Generator, shortest: float, longest: float) -> Floats:
    return np.zeros(round(random.uniform(shortest, longest) * VOICE_RATE))

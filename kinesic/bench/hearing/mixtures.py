"""Sound mixtures from a seed: the robot's speech and another sound."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.random import Generator

from kinesic.bench.hearing.sounds import (
    make_cough,
    make_knock,
    make_music,
    make_noise,
    reverberate,
    say,
    say_as_robot,
    with_level,
)
from kinesic.body.arrays import Floats
from kinesic.body.utterance import Samples
from kinesic.hearing.voice_activity import VOICE_RATE

EventKind = Literal["turn", "short", "cough", "knock", "music", "none"]
TURNS_PER_ROUND = 2  # number of mixtures per round in which a person takes the turn; one mixture of each other kind

ROBOT_TEXTS = (
    "The castle was built on a hill above the river, and for many years nobody lived there at all.",
    "First you open the small door on the left side, and then you take the red box out of the shelf.",
    "Our museum has three floors, and the oldest paintings are in the large hall on the second floor.",
    "When the weather is good, many people walk along the beach and look at the ships in the harbour.",
    "I can show you how the machine works, but you should keep your hands away from the moving parts.",
)
TURN_TEXTS = (
    ("en", "wait, I have a question about that"),
    ("en", "no that is not what I meant"),
    ("en", "can you tell me where the kitchen is"),
    ("en", "excuse me, what time is it now"),
    ("en", "hold on a second please"),
    ("en", "I think we should talk about something else"),
    ("en", "sorry but I did not understand you"),
    ("en", "okay but what about the other one"),
    ("de", "Moment mal, ich habe eine Frage"),
    ("fr", "attendez, je voudrais savoir quelque chose"),
    ("es", "espera un momento por favor"),
    ("it", "scusa, non ho capito niente"),
)
SHORT_TEXTS = (
    *(("en", text) for text in ("mm", "uh huh", "yeah", "okay", "right", "hm")),
    *(("de", "ja"), ("de", "genau"), ("fr", "oui"), ("es", "sí")),
)
TURN_SPEECH_RATES = (0.9, 1.0, 1.2)  # speech rate factors of persons who take the turn
SHORT_SPEECH_RATES = (1.0, 1.2)  # speech rate factors of persons who say a short word
VOICE_PITCHES = (0.75, 1.0, 1.3)  # pitch factors of persons' voices
ROBOT_LEVEL = 0.05  # root mean square of the robot's voice at the microphone
LEVEL_RATIOS = (-6.0, 0.0, 6.0)  # [dB] levels of the event's sound relative to the robot's voice
NOISE_RATIOS = (20.0, 10.0)  # [dB] levels of the event's sound relative to the noise
ECHO_DELAYS = (0.0, 0.03)  # [s] range of the delay from the loudspeaker to the microphone
DISTORTION_GAINS = (1.0, 4.0)  # range of the loudspeaker's gain before saturation; higher gains distort more
SENTENCE_PAUSES = (0.5, 0.3, 0.5)  # [s] pauses before, between and after the robot's two sentences
EVENT_DELAYS = (0.2, 2.5)  # [s] range of the event's start within the second sentence


@dataclass(frozen=True, eq=False)
class Mixture:
    """Microphone sound with the playback and the kind of its event."""

    kind: EventKind
    heard: Samples  # (m,) sound at the microphone, 16 kHz
    played: Samples  # (m,) sound of the robot's loudspeaker, 16 kHz
    begin: float  # [s] start of the event, or the same place without an event


def make_mixtures(seed: int, rounds: int) -> Iterator[Mixture]:
    """Yield rounds of sound mixtures drawn from a seed.

    Each round has two mixtures with a turn and one of each other kind.
    """
    random = np.random.default_rng(seed)
    for _ in range(rounds):
        for kind in (*("turn",) * (TURNS_PER_ROUND - 1), *get_args(EventKind)):
            yield _make_mixture(kind, random)


def _make_mixture(kind: EventKind, random: Generator) -> Mixture:
    first, second = (with_level(say_as_robot(str(random.choice(ROBOT_TEXTS))), ROBOT_LEVEL) for _ in range(2))
    before, between, after = (np.zeros(round(pause * VOICE_RATE)) for pause in SENTENCE_PAUSES)
    played = np.concatenate([before, first, between, second, after])
    distorted = np.tanh(played * random.uniform(*DISTORTION_GAINS))
    heard = with_level(reverberate(distorted, random, random.uniform(*ECHO_DELAYS))[: len(played)], ROBOT_LEVEL)
    level = ROBOT_LEVEL * 10 ** (float(random.choice(LEVEL_RATIOS)) / 20)
    begin = len(before) + len(first) + len(between) + round(random.uniform(*EVENT_DELAYS) * VOICE_RATE)
    if kind != "none":
        event = with_level(reverberate(_make_event(kind, random), random), level)[: len(heard) - begin]
        heard[begin : begin + len(event)] += event
    noise = make_noise(random, len(heard)) * level * 10 ** (-float(random.choice(NOISE_RATIOS)) / 20)
    return Mixture(kind, (heard + noise).astype(np.float32), played.astype(np.float32), begin / VOICE_RATE)


def _make_event(kind: EventKind, random: Generator) -> Floats | Samples:
    if kind in ("turn", "short"):
        texts, rates = (TURN_TEXTS, TURN_SPEECH_RATES) if kind == "turn" else (SHORT_TEXTS, SHORT_SPEECH_RATES)
        language, text = texts[random.integers(len(texts))]
        return say(text, language, float(random.choice(rates)), float(random.choice(VOICE_PITCHES)))
    return {"cough": make_cough, "knock": make_knock, "music": make_music}[kind](random)

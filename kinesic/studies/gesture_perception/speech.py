"""Motions with speech for the mismatching test and system comparisons.

In the mismatching test, a motion is shown with its own speech and with the speech of another text. Both begin at the
same time and end with the shorter one, so that only the motion tells them apart.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.config import ConfigError
from kinesic.body.utterance import Sound
from kinesic.controller.soundtrack import sound
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan, plan_plain_text
from kinesic.studies.gesture_perception.design import OPTION_SEPARATOR, STANDARD_SYSTEM
from kinesic.studies.gesture_perception.stimuli import SampledMotion, changed_setup, sample_motion

MIN_TEXTS = 2  # smallest number of texts of a mismatching test
MAX_TAIL_TIME = 0.3  # [s] longest display of a motion after the end of its speech


@dataclass(frozen=True, eq=False)
class SpokenMotion:
    """Motion of one system for one text, with its speech."""

    text: str  # name of the text
    system: str
    motion: SampledMotion
    begin: float  # [s] start of the speech in the motion
    end: float  # [s] end of the speech in the motion
    sound: Sound | None  # from the start of the motion; None: silent


def plan_spoken_motions(
    texts: Mapping[str, tuple[str | bytes, bool]],
    setup: Setup,
    conditions: Sequence[str],
    progress: Callable[[str], None] = lambda what: None,
) -> tuple[SpokenMotion, ...]:
    """Plan each text with the setup and with each changed setting.

    Args:
        texts: content by name, and whether it is plain text.
        setup: robot, style and options of the system `standard`.
        conditions: changed settings, each a system; see `changed_setup`.
        progress: called with the name of each system.

    Raises:
        BmlError: a document is refused.
        ConfigError: there are too few texts, a text has no speech, or a setting does not exist.
    """
    if len(texts) < MIN_TEXTS:
        raise ConfigError(f"{len(texts)} text is given; a speech study needs {MIN_TEXTS} or more: repeat --text FILE")
    for name in (*texts, *conditions):
        if OPTION_SEPARATOR in name:
            raise ConfigError(f"{name!r} contains {OPTION_SEPARATOR!r}, which separates options: rename it")
    setups = {STANDARD_SYSTEM: setup, **{condition: changed_setup(setup, condition) for condition in conditions}}
    motions = []
    for system, changed in setups.items():
        progress(system)
        for name, (content, is_plain) in texts.items():
            read = plan_plain_text if is_plain else plan
            motions.append(_speak(name, system, read(content, changed, source=name)))
    return tuple(motions)


def choose_foils(durations: Mapping[str, float]) -> dict[str, str]:
    """Assign each text another text's speech of similar duration.

    Args:
        durations: duration of each text's speech [s].
    """
    from scipy.optimize import linear_sum_assignment  # noqa: PLC0415 - slow import, only needed for making a study

    names, times = tuple(durations), np.array(list(durations.values()))
    differences = np.abs(times[:, None] - times[None, :])
    np.fill_diagonal(differences, len(names) * (times.max() + 1.0))  # never its own speech
    return {names[k]: names[j] for k, j in zip(*linear_sum_assignment(differences), strict=True)}


def shown_duration(own: SpokenMotion, other: SpokenMotion) -> float:
    """Return the duration [s] for which a motion is shown.

    It is shown until `MAX_TAIL_TIME` after the end of the shorter speech, at most until its own end.
    """
    spoken = min(own.end - own.begin, other.end - other.begin)
    return min(own.begin + spoken + MAX_TAIL_TIME, own.motion.duration)


def _speak(name: str, system: str, planned: Plan) -> SpokenMotion:
    motion = sample_motion(planned)
    if not motion.words:
        raise ConfigError(f"text {name} has no speech; a speech study needs one in each text")
    begin, end = motion.words[0].begin, max(caption.end for caption in motion.words)
    heard = sound(planned)
    silent = motion if heard is None else replace(motion, words=())
    return SpokenMotion(name, system, silent, begin, end, heard)

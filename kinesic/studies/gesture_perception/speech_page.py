"""HTML page of a speech study: mismatching test and comparisons of systems."""

import hashlib
import json
from base64 import b64encode
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path

import numpy as np

from kinesic.body.robot import Robot
from kinesic.body.utterance import Sound
from kinesic.report.report import Json
from kinesic.report.scene import SCENE_SCRIPTS, read_scripts, scene_data
from kinesic.studies.gesture_perception.answers import ANSWER_COLUMNS
from kinesic.studies.gesture_perception.design import OPTION_SEPARATOR
from kinesic.studies.gesture_perception.page import TEMPLATE_FOLDER
from kinesic.studies.gesture_perception.speech import SpokenMotion, choose_foils, shown_duration
from kinesic.studies.gesture_perception.stimuli import motion_data
from kinesic.studies.questionnaire.page import Questionnaire, write_questionnaire

MATCHES_PER_SYSTEM = 8  # largest number of motions per system and participant; half have their own speech first
PAIRS_PER_COMPARISON = 4  # largest number of texts per participant for each pair of systems
MAX_SAMPLE = 32767  # largest value of a 16-bit audio sample


def write_speech_page(path: Path, robot: Robot, spoken: Sequence[SpokenMotion], *, post_to: str = "") -> int:
    """Write the HTML page of a speech study.

    Args:
        path: path of the page.
        robot: robot that performs.
        spoken: motions of each system for each text.
        post_to: URL that receives each participant's answers as CSV; empty: answers are only offered as a file.

    Returns:
        Number of trials of a participant.

    Raises:
        ConfigError: `post_to` is not an http or https URL.
    """
    numbers = {(each.text, each.system): k for k, each in enumerate(spoken)}
    texts, systems = (list(dict.fromkeys(names)) for names in zip(*numbers, strict=True))
    durations = {
        text: spoken[numbers[text, systems[0]]].end - spoken[numbers[text, systems[0]]].begin for text in texts
    }
    foils = choose_foils(durations)
    trials: list[Json] = []
    for own in spoken:
        foil = spoken[numbers[foils[own.text], own.system]]
        motion: Json = dict.fromkeys((own.text, foil.text), numbers[own.text, own.system])
        speeches: Json = {item.text: numbers[item.text, item.system] for item in (own, foil)}
        trial = _trial("mismatching", own.text, own.system, [own.text, foil.text], motion)
        trials.append({**trial, "speeches": speeches, "until": round(shown_duration(own, foil), 3)})
    pairs = list(combinations(systems, 2))
    for one, other in pairs:
        for text in texts:
            motions: Json = {system: numbers[text, system] for system in (one, other)}
            trials.append(_trial("realism", text, f"{one} {other}", [one, other], motions))
    count = len(systems) * min(len(texts), MATCHES_PER_SYSTEM) + len(pairs) * min(len(texts), PAIRS_PER_COMPARISON)
    sounds, sound_numbers = _pack_sounds(spoken)
    content: dict[str, Json] = {
        "trials": trials,
        "meanings": {},
        "motions": motion_data([item.motion for item in spoken]),
        "speeches": [
            {"begin": round(each.begin, 3), "sound": number} for each, number in zip(spoken, sound_numbers, strict=True)
        ],
        "sounds": sounds,
        "robot": scene_data(robot),
        "recognitions": 0,
        "comparisons": 0,
        "matches": MATCHES_PER_SYSTEM,
        "realisms": PAIRS_PER_COMPARISON,
        "separator": OPTION_SEPARATOR,
        "columns": list(ANSWER_COLUMNS),
        "most": count,
        "pace": 1.0,
    }
    content_hash = hashlib.sha256(json.dumps(content).encode()).hexdigest()[:12]
    questionnaire = Questionnaire(
        {"name": f"kinesic-speech-{content_hash}", **content},
        template=TEMPLATE_FOLDER / "speech.jinja",
        script="\n".join((read_scripts(SCENE_SCRIPTS), (TEMPLATE_FOLDER / "gestures.js").read_text(encoding="utf-8"))),
        shown=count,
        variables={"heard": any(item.sound is not None for item in spoken)},
    )
    write_questionnaire(path, questionnaire, post_to=post_to)
    return count


def _trial(task: str, stimulus: str, condition: str, options: list[str], motions: Json) -> dict[str, Json]:
    return {
        "id": f"{task} {condition} {stimulus}",
        "task": task,
        "stimulus": stimulus,
        "condition": condition,
        "options": [*options],
        "motions": motions,
    }


def _pack_sounds(spoken: Sequence[SpokenMotion]) -> tuple[list[Json], list[int]]:
    """Return the distinct sounds and each motion's sound index, -1 if silent."""
    numbers: dict[tuple[int, bytes], int] = {}
    order = []
    for item in spoken:
        key = None if item.sound is None else (item.sound.rate, _pack(item.sound))
        order.append(-1 if key is None else numbers.setdefault(key, len(numbers)))
    return [{"rate": rate, "samples": b64encode(data).decode()} for rate, data in numbers], order


def _pack(heard: Sound) -> bytes:
    return np.clip(np.rint(MAX_SAMPLE * heard.samples), -MAX_SAMPLE, MAX_SAMPLE).astype("<i2").tobytes()

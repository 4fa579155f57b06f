"""Page of the speech study in a browser, and the answers that it writes."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.body.utterance import Sound
from kinesic.studies.gesture_perception.analysis import analyse_matches
from kinesic.studies.gesture_perception.answers import read_gesture_answers
from kinesic.studies.gesture_perception.elo import rate_systems
from kinesic.studies.gesture_perception.speech import SpokenMotion
from kinesic.studies.gesture_perception.speech_page import write_speech_page
from kinesic.studies.gesture_perception.stimuli import SampledMotion

from ...chromium import binary, opened
from .test_page import choose, download_answers

pytestmark = pytest.mark.realtime

TEXTS, SYSTEMS = ("one", "two"), ("standard", "idle=0")
RATE = 8000  # [Hz] sample rate of the simulated speech
RIGHT = 'document.querySelector(`input[value="${byId.get(state.order[state.place - 1].id).stimulus}"]`)'
STANDARD = "document.querySelector('input[value=standard]')"


def speak(text: str, system: str, seconds: float, robot: Robot) -> SpokenMotion:
    """Return a simple motion with a tone that starts at 0.5 s."""
    joints = len(robot.skeleton.names)
    angles = np.linspace(0.0, seconds / 10, round(50 * seconds) + 51)[:, None] * np.ones(joints)
    samples = np.concatenate([np.zeros(RATE // 2), 0.1 * np.ones(round(RATE * seconds))])
    return SpokenMotion(text, system, SampledMotion(angles), 0.5, 0.5 + seconds, Sound.of(RATE, samples))


def test_answers_of_a_perfect_participant_of_a_speech_study_are_read_back(known, tmp_path: Path):
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    robot: Robot = known.robot
    spoken = [speak(text, system, 1.0 + k / 5, robot) for system in SYSTEMS for k, text in enumerate(TEXTS)]
    page_file = tmp_path / "index.html"
    assert write_speech_page(page_file, robot, spoken) == 6
    with opened(page_file.as_uri()) as page:
        page.until("document.readyState === 'complete' && typeof state === 'object'")
        if page.value("scene === null"):
            pytest.skip("this Chromium draws no WebGL 2")
        page.value("study.pace = 200")
        page.value("window.started = [], window.plain = AudioBufferSourceNode.prototype.start")
        page.value(
            "AudioBufferSourceNode.prototype.start = function (...times) { started.push([times, this.buffer.length]) }"
        )
        page.value("AudioBufferSourceNode.prototype.stop = () => {}")
        page.click("#begin")
        with page.undrawn():
            for k in range(6):
                choose(page, RIGHT if k < 4 else STANDARD)
        page.until("!document.getElementById('thanks').hidden")
        file = download_answers(page, tmp_path / "answers.csv")
        started = page.value("started")
    assert len(started) == 8, "each motion of the mismatching test has two speeches, the others have none"
    lengths = Counter(length for _, length in started)
    assert set(lengths) == {round(RATE * (1.5 + k / 5)) for k in range(2)}
    answers = read_gesture_answers([file])
    matched = analyse_matches(answers.matches)
    assert matched is not None
    assert {system: share.rate for system, share in matched.systems.items()} == dict.fromkeys(SYSTEMS, 1.0)
    assert Counter(match.system for match in answers.matches) == dict.fromkeys(SYSTEMS, 2)
    rated = rate_systems(answers.pair_choices, 0.95)
    assert rated is not None
    assert [(name, each.wins) for name, each in rated.ratings.items()] == [("standard", 2), ("idle=0", 0)]

"""HTML page of a gesture study, with a robot drawn by JavaScript.

Making it needs neither films nor OpenGL.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from kinesic.body.robot import Robot
from kinesic.report.report import Json
from kinesic.report.scene import SCENE_SCRIPTS, read_scripts, scene_data
from kinesic.studies.gesture_perception.answers import ANSWER_COLUMNS
from kinesic.studies.gesture_perception.design import OPTION_SEPARATOR, StudyQuestion
from kinesic.studies.gesture_perception.stimuli import SampledMotion, StimulusPair, motion_data
from kinesic.studies.questionnaire.page import Questionnaire, write_questionnaire

TEMPLATE_FOLDER = Path(__file__).parent
RECOGNITION_COUNT = 24  # largest number of gestures per participant; the right answer is four times in each position

COMPARISON_COUNT = 6  # motion pairs per condition and participant at most; half show the standard motion first


def write_gesture_page(
    path: Path,
    robot: Robot,
    questions: Sequence[StudyQuestion],
    motions: Mapping[str, SampledMotion],
    pairs: Sequence[StimulusPair] = (),
    *,
    post_to: str = "",
) -> None:
    """Write the HTML page of a gesture study.

    Args:
        path: path of the page.
        robot: robot that performs.
        questions: questions of the recognition task.
        motions: motions of their gestures, by id.
        pairs: pairs to compare.
        post_to: URL that receives each participant's answers as CSV; empty: answers are only offered as a file.

    Raises:
        ConfigError: `post_to` is not an http or https URL.
    """
    question_motions = [motions[question.right.gesture] for question in questions]
    shown = list(dict.fromkeys([*question_motions, *(motion for pair in pairs for motion in pair.motions.values())]))
    motion_index = {motion: k for k, motion in enumerate(shown)}
    trials = [
        *(_recognition(question, motion_index[motions[question.right.gesture]]) for question in questions),
        *(_comparison(pair, {side: motion_index[motion] for side, motion in pair.motions.items()}) for pair in pairs),
    ]
    meanings = {meaning.gesture: meaning.label for question in questions for meaning in question.options}
    conditions = {pair.condition for pair in pairs}
    trial_count = min(len(questions), RECOGNITION_COUNT) + sum(
        min(sum(pair.condition == condition for pair in pairs), COMPARISON_COUNT) for condition in conditions
    )
    content: dict[str, Json] = {
        "trials": [*trials],
        "meanings": {**meanings},
        "motions": motion_data(shown),
        "robot": scene_data(robot),
        "recognitions": RECOGNITION_COUNT,
        "comparisons": COMPARISON_COUNT,
        "separator": OPTION_SEPARATOR,
        "columns": list(ANSWER_COLUMNS),
        "most": trial_count,
        "pace": 1.0,
    }
    content_hash = hashlib.sha256(json.dumps(content).encode()).hexdigest()[:12]
    questionnaire = Questionnaire(
        {"name": f"kinesic-gestures-{content_hash}", **content},
        template=TEMPLATE_FOLDER / "gestures.jinja",
        script="\n".join((read_scripts(SCENE_SCRIPTS), (TEMPLATE_FOLDER / "gestures.js").read_text(encoding="utf-8"))),
        shown=trial_count,
    )
    write_questionnaire(path, questionnaire, post_to=post_to)


def _recognition(question: StudyQuestion, motion: int) -> Json:
    gesture = question.right.gesture
    return {
        "id": f"recognition {gesture}",
        "task": "recognition",
        "stimulus": gesture,
        "condition": "",
        "options": [meaning.gesture for meaning in question.options],
        "motions": {gesture: motion},
    }


def _comparison(pair: StimulusPair, motions: Mapping[str, int]) -> Json:
    return {
        "id": f"comparison {pair.condition} {pair.stimulus}",
        "task": "comparison",
        "stimulus": pair.stimulus,
        "condition": pair.condition,
        "options": list(motions),
        "motions": {**motions},
    }

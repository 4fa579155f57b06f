"""The page of a study of gestures: it draws the robot itself, so that making it needs neither films nor OpenGL."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from kinesic.body.robot import Robot
from kinesic.report.report import Json
from kinesic.report.scene import SCENE_SCRIPTS, read_scripts, scene_data
from kinesic.studies.gesture_perception.answers import COLUMNS
from kinesic.studies.gesture_perception.design import SEPARATOR, StudyQuestion
from kinesic.studies.gesture_perception.stimuli import SampledMotion, StimulusPair, motion_data
from kinesic.studies.questionnaire.page import write_questionnaire

HERE = Path(__file__).parent
RECOGNITIONS = 24  # gestures that a participant is asked for; the right one stands in each place four times

COMPARISONS = 6  # pairs of each condition that a participant compares, half of them with the standard first


def write_gesture_page(
    path: Path,
    robot: Robot,
    questions: Sequence[StudyQuestion],
    motions: Mapping[str, SampledMotion],
    pairs: Sequence[StimulusPair] = (),
    *,
    post_to: str = "",
) -> None:
    """Writes the page.

    Args:
        path: of the page.
        robot: that performs.
        questions: what is asked for.
        motions: of their gestures, by id.
        pairs: what is compared.
        post_to: URL that each participant's answers are sent to as CSV; empty: they are only offered as a file.

    Raises:
        ConfigError: `post_to` is no http or https URL.
    """
    asked = [motions[question.right.gesture] for question in questions]
    shown = list(dict.fromkeys([*asked, *(motion for pair in pairs for motion in pair.motions.values())]))
    place = {motion: k for k, motion in enumerate(shown)}
    trials = [
        *(_recognition(question, place[motions[question.right.gesture]]) for question in questions),
        *(_comparison(pair, {side: place[motion] for side, motion in pair.motions.items()}) for pair in pairs),
    ]
    meanings = {meaning.gesture: meaning.label for question in questions for meaning in question.options}
    conditions = {pair.condition for pair in pairs}
    most = min(len(questions), RECOGNITIONS) + sum(
        min(sum(pair.condition == condition for pair in pairs), COMPARISONS) for condition in conditions
    )
    content: dict[str, Json] = {
        "trials": [*trials],
        "meanings": {**meanings},
        "motions": motion_data(shown),
        "robot": scene_data(robot),
        "recognitions": RECOGNITIONS,
        "comparisons": COMPARISONS,
        "separator": SEPARATOR,
        "columns": list(COLUMNS),
        "most": most,
        "pace": 1.0,
    }
    print_of_content = hashlib.sha256(json.dumps(content).encode()).hexdigest()[:12]
    write_questionnaire(
        path,
        {"name": f"kinesic-gestures-{print_of_content}", **content},
        template=HERE / "gestures.jinja",
        script="\n".join((read_scripts(SCENE_SCRIPTS), (HERE / "gestures.js").read_text(encoding="utf-8"))),
        post_to=post_to,
        shown=most,
    )


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

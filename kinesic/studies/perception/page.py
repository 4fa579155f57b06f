"""Stimuli of the face study, and the page that asks about them.

A stimulus is a picture of an expression at its peak, or a short film.

The page shows each stimulus once; it needs a browser and the folder of stimuli but no server.
"""

from collections.abc import Iterator, Sequence
from itertools import groupby
from operator import attrgetter
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.expressivity.face.expressions import Envelope
from kinesic.face.render.camera import CLOSE_CAMERA
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET, Preset
from kinesic.face.show.files import save_film, save_picture
from kinesic.report.report import Json
from kinesic.studies.perception.answers import ACCEPTED_AGES, ANSWER_COLUMNS
from kinesic.studies.perception.design import FACIAL_ACTIONS, LIKERT_POINTS, STIMULI_PER_CELL, Stimulus, list_stimuli
from kinesic.studies.questionnaire.page import Questionnaire, write_questionnaire

TEMPLATE_FOLDER = Path(__file__).parent
LIKERT_LABELS = ("totally disagree", "disagree", "neither", "agree", "totally agree")
OPINION_STATEMENTS = {"naturalness": "This face looks natural", "realism": "This face looks realistic"}
PICTURE_RATE = 24.0  # [Hz] picture rate of the study's films
EXPRESSION_ENVELOPE = Envelope(0.2, 0.7, 1.5, 2.0)  # [s] times of an expression: start, full, release, end
FILM_DURATION = 2.2  # [s] duration of the film of one expression


def write_study_page(path: Path, *, folder: str = "stimuli", post_to: str = "") -> None:
    """Write the HTML page of the face study.

    Args:
        path: path of the page.
        folder: folder of the stimuli, relative to the page.
        post_to: URL that receives each participant's answers as CSV; empty: answers are only offered as a file.

    Raises:
        ConfigError: `post_to` is not an http or https URL.
    """
    study: dict[str, Json] = {
        "name": "kinesic-study",
        "most": len(list_stimuli()),
        "stimuli": [
            {
                "id": stimulus.code,
                "file": f"{folder}/{file_of(stimulus)}",
                "agent": stimulus.agent,
                "action": stimulus.action.name,
                "strength": stimulus.strength,
                "wrinkles": "with" if stimulus.wrinkles else "without",
                "presentation": stimulus.presentation,
                "region": stimulus.action.region,
            }
            for stimulus in list_stimuli()
        ],
        "questions": {
            region: {**{a.name: a.label for a in FACIAL_ACTIONS if a.region == region}, **OPINION_STATEMENTS}
            for region in ("upper", "lower")
        },
        "scale": list(LIKERT_LABELS),
        "points": LIKERT_POINTS,
        "columns": list(ANSWER_COLUMNS),
        "perCell": STIMULI_PER_CELL,
        "seconds": FILM_DURATION,
    }
    questionnaire = Questionnaire(
        study,
        template=TEMPLATE_FOLDER / "study.jinja",
        script=(TEMPLATE_FOLDER / "study.js").read_text(encoding="utf-8"),
        shown=4 * STIMULI_PER_CELL,
        images="*",
        variables={"ages": [ACCEPTED_AGES[0], ACCEPTED_AGES[-1]]},
    )
    write_questionnaire(path, questionnaire, post_to=post_to)


def file_of(stimulus: Stimulus) -> str:
    """Return a stimulus' file name, which reveals no condition."""
    return f"{stimulus.code}{'.webp' if stimulus.presentation == 'animation' else '.png'}"


def draw_stimuli(
    selected: Sequence[Stimulus], folder: Path, *, size: int = 384, preset: Preset = NORMAL_PRESET
) -> Iterator[Path]:
    """Draw the faces of stimuli into a folder and yield each file.

    Args:
        selected: stimuli to draw.
        folder: folder of the files.
        size: side of a picture [pixels].
        preset: rendering preset; the stimulus switches wrinkles on or off.

    Raises:
        DisplayError: drawing is not possible.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for agent, group in groupby(sorted(selected, key=attrgetter("agent")), key=attrgetter("agent")):
        with Portrait(agent, preset=preset, size=(size, size)) as portrait:
            for stimulus in group:
                path = folder / file_of(stimulus)
                if stimulus.presentation == "animation":
                    save_film(list(_film(portrait, stimulus)), path, rate=PICTURE_RATE, once=True)
                else:
                    save_picture(_picture(portrait, stimulus, 1.0), path)
                yield path


def _film(portrait: Portrait, stimulus: Stimulus) -> Iterator[Picture]:
    for intensity in EXPRESSION_ENVELOPE.at(np.arange(round(FILM_DURATION * PICTURE_RATE)) / PICTURE_RATE).tolist():
        yield _picture(portrait, stimulus, intensity)


def _picture(portrait: Portrait, stimulus: Stimulus, intensity: float) -> Picture:
    units = {unit: intensity * peak for unit, peak in stimulus.units.items()}
    return portrait.draw(units, CLOSE_CAMERA, gain=1.0 if stimulus.wrinkles else 0.0)

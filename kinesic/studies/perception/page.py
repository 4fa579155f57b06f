"""What participants see: stimuli, each a picture of an expression at its peak or a short film, and the page that asks.

The page shows each stimulus once; it needs a browser and the folder of stimuli, no server.
"""

from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.expressivity.face.expressions import Envelope
from kinesic.face.render.camera import CLOSE
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL, Preset
from kinesic.face.show.files import save, save_film
from kinesic.report.report import Json
from kinesic.studies.perception.answers import AGES, COLUMNS
from kinesic.studies.perception.design import ACTIONS, PER_CELL, POINTS, Stimulus, stimuli
from kinesic.studies.questionnaire.page import write_questionnaire

HERE = Path(__file__).parent
SCALE = ("totally disagree", "disagree", "neither", "agree", "totally agree")
OPINIONS = {"naturalness": "This face looks natural", "realism": "This face looks realistic"}
PICTURE_RATE = 24.0  # [Hz] of films
COURSE = Envelope(0.2, 0.7, 1.5, 2.0)  # [s] of an expression: from rest, up, held, and gone
SECONDS = 2.2  # of a film


def write_study_page(path: Path, *, folder: str = "stimuli", post_to: str = "") -> None:
    """Writes the page.

    Args:
        path: of the page.
        folder: of the stimuli, as seen from the page.
        post_to: URL that each participant's answers are sent to as CSV; empty: they are only offered as a file.

    Raises:
        ConfigError: it is no http or https URL.
    """
    study: dict[str, Json] = {
        "name": "kinesic-study",
        "most": len(stimuli()),
        "stimuli": [
            {
                "id": each.id,
                "file": f"{folder}/{file_of(each)}",
                "agent": each.agent,
                "action": each.action.name,
                "strength": each.strength,
                "wrinkles": "with" if each.wrinkles else "without",
                "presentation": each.presentation,
                "region": each.action.region,
            }
            for each in stimuli()
        ],
        "questions": {
            region: {**{a.name: a.label for a in ACTIONS if a.region == region}, **OPINIONS}
            for region in ("upper", "lower")
        },
        "scale": list(SCALE),
        "points": POINTS,
        "columns": list(COLUMNS),
        "perCell": PER_CELL,
        "seconds": SECONDS,
    }
    write_questionnaire(
        path,
        study,
        template=HERE / "study.jinja",
        script=(HERE / "study.js").read_text(encoding="utf-8"),
        post_to=post_to,
        shown=4 * PER_CELL,
        images="*",
        told={"ages": [AGES[0], AGES[-1]]},
    )


def file_of(stimulus: Stimulus) -> str:
    """Names the file of a stimulus."""
    return f"{stimulus.id}{'.webp' if stimulus.presentation == 'animation' else '.png'}"


def draw_stimuli(
    selected: Sequence[Stimulus], folder: Path, *, size: int = 384, preset: Preset = NORMAL
) -> Iterator[Path]:
    """Draws stimuli into a folder, which is made; yields each file when it is there.

    Args:
        selected: those that are drawn.
        folder: where to.
        size: [pixels] along a side.
        preset: how much is drawn; wrinkles are switched by the stimulus.

    Raises:
        DisplayError: nothing can be drawn here.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for agent, own in groupby(sorted(selected, key=lambda each: each.agent), key=lambda each: each.agent):
        with Portrait(agent, preset=preset, size=(size, size)) as portrait:
            for stimulus in own:
                path = folder / file_of(stimulus)
                if stimulus.presentation == "animation":
                    save_film(list(_film(portrait, stimulus)), path, rate=PICTURE_RATE, once=True)
                else:
                    save(_picture(portrait, stimulus, 1.0), path)
                yield path


def _film(portrait: Portrait, stimulus: Stimulus) -> Iterator[Picture]:
    for share in COURSE.at(np.arange(round(SECONDS * PICTURE_RATE)) / PICTURE_RATE).tolist():
        yield _picture(portrait, stimulus, share)


def _picture(portrait: Portrait, stimulus: Stimulus, share: float) -> Picture:
    units = {unit: share * peak for unit, peak in stimulus.units.items()}
    return portrait.draw(units, CLOSE, gain=1.0 if stimulus.wrinkles else 0.0)

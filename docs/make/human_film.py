"""Draw docs/pictures/human-film.png: six frames of the human model's welcome film."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

from kinesic import Performer
from kinesic.body.config import CONFIGS
from kinesic.face.render.figure import FILM_PRESET, UPPER_BODY_CAMERA, FigurePortrait
from kinesic.files.caption_band import write_caption
from kinesic.report.figure_film import FigureFilm, frame_motion

DOCS = Path(__file__).resolve().parents[1]
FRAME_TIMES = (1.2, 2.6, 4.4, 6.2, 8.0, 9.2)  # [s] film times of the six pictures
ROW_LENGTH = 3  # number of pictures in a row
PICTURE_SIZE = (480, 270)  # [pixels] width and height of one picture

if __name__ == "__main__":
    performer = Performer("human", voice="auto")
    run = performer.perform(performer.plan(CONFIGS / "bml" / "welcome.bml", source="welcome.bml"))
    film = FigureFilm.of(run.plan, run.measured.times, run.measured.angles)
    middle, field = frame_motion(film.robot, film.angles, UPPER_BODY_CAMERA, aspect=film.size[0] / film.size[1])
    camera, pictures = replace(UPPER_BODY_CAMERA, pivot=middle, field_deg=field), []
    with FigurePortrait(film.robot.skeleton, preset=FILM_PRESET, size=film.size) as portrait:
        for k in (round(time * film.rate) for time in FRAME_TIMES):
            picture = portrait.draw(film.angles[k], film.units[k], camera).copy()
            write_caption(picture, film.words[k])
            pictures.append(np.asarray(Image.fromarray(picture).resize(PICTURE_SIZE, Image.Resampling.LANCZOS)))
    rows = [np.concatenate(pictures[k : k + ROW_LENGTH], axis=1) for k in range(0, len(pictures), ROW_LENGTH)]
    whole = Image.fromarray(np.concatenate(rows)).quantize(256, dither=Image.Dither.FLOYDSTEINBERG)
    whole.save(DOCS / "pictures" / "human-film.png", optimize=True)

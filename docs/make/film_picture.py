"""Draw docs/pictures/film.png: two moments of the film of welcome.bml, and the same with the rendered head."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image

from kinesic import Performer
from kinesic.body.config import CONFIGS
from kinesic.files.film_reader import FilmReader
from kinesic.files.film_settings import FilmSettings
from kinesic.report.films import TwinFilm, draw_films, film_processes
from kinesic.report.output import face_film

DOCS = Path(__file__).resolve().parents[1]
FRAME_TIMES = (2.5, 9.0)  # [s] film times of the two pictures in a row
PICTURE_SIZE = (640, 360)  # [pixels] width and height of one picture
FILM_SETTINGS = FilmSettings(rate=2.0)

if __name__ == "__main__":
    performer = Performer("upper22", voice="auto")
    run = performer.perform(performer.plan(CONFIGS / "bml" / "welcome.bml", source="welcome.bml"))
    rows = []
    with TemporaryDirectory() as folder, film_processes() as processes:
        film, painted, face = (Path(folder) / f"{name}.webp" for name in ("film", "painted", "face"))
        job = replace(TwinFilm.of(run.plan, run.measured.times, run.measured.angles, FILM_SETTINGS), after=face)
        rendered = face_film(run.plan, FILM_SETTINGS.rate)
        assert rendered is not None
        draw_films({film: job, face: rendered}, processes)
        assert not replace(job, after=None).draw(painted, lambda share: None)
        for path in (painted, film):
            reader = FilmReader(path)
            shown = [
                Image.fromarray(reader.at(time)).resize(PICTURE_SIZE, Image.Resampling.LANCZOS) for time in FRAME_TIMES
            ]
            rows.append(np.concatenate([np.asarray(picture) for picture in shown], axis=1))
    whole = Image.fromarray(np.concatenate(rows)).quantize(256, dither=Image.Dither.FLOYDSTEINBERG)
    whole.save(DOCS / "pictures" / "film.png", optimize=True)

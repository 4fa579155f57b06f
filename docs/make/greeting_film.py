"""Film docs/pictures/greeting.webp: the built-in greeting on upper36, small enough for the README."""

from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from kinesic import Performer
from kinesic.files.film_reader import FilmReader
from kinesic.files.film_settings import FilmSettings
from kinesic.report.films import TwinFilm, draw_films, film_processes

FILM_FILE = Path(__file__).resolve().parents[1] / "pictures" / "greeting.webp"
FILM_RATE = 10.0  # [Hz] frame rate of the film
FILM_SIZE = (480, 270)  # [pixels] width and height of the film

if __name__ == "__main__":
    performer = Performer("upper36", voice="auto")
    run = performer.perform(performer.plan("welcome"))
    with TemporaryDirectory() as folder, film_processes() as processes:
        film = Path(folder) / "film.webp"
        settings = FilmSettings(rate=FILM_RATE)
        draw_films({film: TwinFilm.of(run.plan, run.measured.times, run.measured.angles, settings)}, processes)
        reader = FilmReader(film)
        times = [index / FILM_RATE for index in range(int(run.plan.duration * FILM_RATE))]
        frames = [Image.fromarray(reader.at(time)).resize(FILM_SIZE, Image.Resampling.LANCZOS) for time in times]
    duration = round(1000 / FILM_RATE)
    frames[0].save(FILM_FILE, save_all=True, append_images=frames[1:], duration=duration, loop=0, quality=40, method=6)

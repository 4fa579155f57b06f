"""Tests of reading a film while it is being written."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event

import numpy as np
import pytest

from kinesic.body.arrays import Picture
from kinesic.files.film_file import MAX_PENDING_PICTURES, WebpFilm
from kinesic.files.growing_film import GrowingFilm

PICTURE_SIZE = (64, 48)
PICTURE_COUNT = 2 * MAX_PENDING_PICTURES


def grey(k: int) -> Picture:
    return np.full((48, 64, 3), 200, dtype=np.uint8) - np.uint8(8 * k)


def write(path: Path, go_on: Event, *, broken: bool) -> None:
    """Write pictures of 100 ms, the last one after `go_on` is set."""
    with WebpFilm(path, PICTURE_SIZE, in_parts=False) as film:
        for k in range(PICTURE_COUNT - 1):
            film.write(grey(k), None, 100)
        film._file.flush()
        go_on.wait()
        if broken:
            raise ZeroDivisionError
        film.write(grey(PICTURE_COUNT - 1), None, 100)


@pytest.mark.parametrize("broken", [False, True])
def test_film_is_readable_while_it_is_written_and_has_no_pictures_after_a_failed_write(
    tmp_path: Path, broken: bool
) -> None:
    path, go_on = tmp_path / "x.webp", Event()
    path.touch()
    film = GrowingFilm(path)
    with ThreadPoolExecutor(2) as threads:
        writing = threads.submit(write, path, go_on, broken=broken)
        first = film.at(0.05)
        assert not writing.done()
        assert first is not None
        assert abs(float(first.mean()) - 200) < 2
        last = threads.submit(film.at, 0.1 * PICTURE_COUNT - 0.05)
        go_on.set()
        seen = last.result(timeout=10.0)
    if broken:
        assert seen is None
        assert film.at(99.0) is None
        assert not path.exists(), "a film that broke off is none"
    else:
        assert seen is not None
        assert abs(float(seen.mean()) - float(grey(PICTURE_COUNT - 1).mean())) < 2
        assert film.at(99.0) is seen, "the last one stays"


def test_film_reader_draws_changed_regions_over_the_previous_picture(tmp_path: Path) -> None:
    path, pictures = tmp_path / "x.webp", [grey(0) for _ in range(4)]
    for k, picture in enumerate(pictures):
        picture[10:26, 12 * k : 12 * k + 16] = 40
    with WebpFilm(path, PICTURE_SIZE) as writer:
        for picture in pictures:
            writer.write(picture, None, 100)
    for moment in (0.001, 0.05, 0.0999):
        film = GrowingFilm(path)
        for k, picture in enumerate(pictures):
            seen = film.at(0.1 * k + moment)
            assert seen is not None
            assert np.abs(seen.astype(int) - picture).mean() < 3


def test_film_without_a_running_writer_has_no_picture_after_a_timeout(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kinesic.files.growing_film.WRITER_TIMEOUT", 0.05)
    path = tmp_path / "x.webp"
    with pytest.raises(FileNotFoundError):
        GrowingFilm(path)
    path.touch()
    film = GrowingFilm(path)
    assert film.at(0.0) is None
    assert film.at(1.0) is None

"""Tests of writing films as animated WebP and H.264."""

import json
import shutil
import stat
import subprocess
import sys
import threading
import wave
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.arrays import Picture
from kinesic.files import film_file
from kinesic.files.film_file import EncodingError, Mp4Film, WebpFilm, find_encoder, open_film, picture_durations
from kinesic.files.film_reader import FilmReader

PICTURE_SIZE = (64, 48)
ENCODER_PROGRAM = """#!{python}
import sys
import threading
from pathlib import Path
pictures = sys.stdin.buffer.read()
if b"fail" in pictures:
    sys.exit("first line\\nno such codec")
Path(sys.argv[-1]).write_text(repr((len(pictures), sys.argv[1:])))
"""


def moving(count: int) -> list[Picture]:
    """Return pictures of a light square that moves over a dark background."""
    pictures = [np.full((48, 64, 3), 40, dtype=np.uint8) for _ in range(count)]
    for k, picture in enumerate(pictures):
        picture[10:26, 3 * k : 3 * k + 16] = 220
    return pictures


def written(pictures: list[Picture], path: Path, *, rate: float = 30.0) -> list[Picture]:
    """Write pictures to a WebP file and return the pictures read back."""
    with WebpFilm(path, PICTURE_SIZE) as film:
        for picture, shown in zip(pictures, picture_durations(len(pictures), rate), strict=True):
            film.write(picture, None, shown)
    with Image.open(path) as seen:
        results = []
        for k in range(getattr(seen, "n_frames", 1)):
            seen.seek(k)
            results.append(np.asarray(seen.convert("RGB")))
        return results


def test_webp_film_pictures_are_restored_although_only_changed_regions_are_stored(tmp_path: Path):
    pictures = moving(12)
    result = written(pictures, tmp_path / "x.webp")
    assert len(result) == 12
    for asked, seen in zip(pictures, result, strict=True):
        assert seen.shape == asked.shape
        assert np.abs(seen.astype(int) - asked).mean() < 3.0
    whole = (tmp_path / "x.webp").stat().st_size
    with WebpFilm(tmp_path / "still.webp", PICTURE_SIZE) as film:
        film.write(pictures[0], None, 33)
    assert whole < 12 * (tmp_path / "still.webp").stat().st_size


def test_equal_successive_film_pictures_are_merged(tmp_path: Path):
    one, other = moving(2)
    assert len(written([one, one, one, other, other], tmp_path / "x.webp", rate=30.0)) == 2
    film = FilmReader(tmp_path / "x.webp")
    assert np.abs(film.at(0.099).astype(int) - one).mean() < 3.0
    assert np.abs(film.at(0.101).astype(int) - other).mean() < 3.0
    assert film.at(9.0) is film.at(9.1), "a picture is read once"


@pytest.mark.parametrize("rate", [30.0, 24.0, 7.3])
def test_rounded_picture_durations_add_up_to_the_film_duration(rate: float):
    assert abs(sum(picture_durations(100, rate)) - 1000 * 100 / rate) <= 0.5
    assert max(picture_durations(100, rate)) - min(picture_durations(100, rate)) <= 1


def test_webp_film_writer_limits_the_number_of_pictures_that_wait_for_encoding(tmp_path: Path):
    with WebpFilm(tmp_path / "x.webp", PICTURE_SIZE) as film:
        for picture in moving(16) * 4:
            film.write(picture, None, 33)
            assert len(film._waiting) <= film_file.MAX_PENDING_PICTURES
    with Image.open(tmp_path / "x.webp") as seen:
        assert seen.n_frames == 64


def test_film_that_fails_while_it_is_written_leaves_no_encoder_thread(tmp_path: Path):
    before = threading.active_count()

    def stop() -> None:
        with WebpFilm(tmp_path / "x.webp", PICTURE_SIZE) as film:
            for picture in moving(3):
                film.write(picture, None, 33)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        stop()
    assert threading.active_count() == before


@pytest.fixture
def encoder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install a fake ffmpeg that records its input and arguments."""
    program = tmp_path / "ffmpeg"
    program.write_text(ENCODER_PROGRAM.format(python=sys.executable))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)


@pytest.mark.usefixtures("encoder")
def test_mp4_encoder_gets_whole_pictures_rate_and_sound(tmp_path: Path):
    path = tmp_path / "x.mp4"
    with open_film(path, PICTURE_SIZE, rate=30.0, sound=tmp_path / "voice.wav") as film:
        for picture in moving(5):
            film.write(picture, (0, 0, 2, 2), 33)
    size, words = eval(path.read_text())
    assert size == 5 * 64 * 48 * 3
    assert words[words.index("-s") + 1] == "64x48"
    assert words[words.index("-r") + 1] == "30"
    assert words.count("-i") == 2
    assert str(tmp_path / "voice.wav") in words
    assert "libx264" in words


@pytest.mark.usefixtures("encoder")
def test_error_message_of_the_mp4_encoder_is_reported(tmp_path: Path):
    spoilt = np.frombuffer(b"fail" * (64 * 48 * 3 // 4), dtype=np.uint8).reshape(48, 64, 3)
    with (
        pytest.raises(EncodingError, match=r"x\.mp4: no such codec$"),
        Mp4Film(tmp_path / "x.mp4", PICTURE_SIZE, rate=30.0) as film,
    ):
        film.write(spoilt, None, 33)


def test_mp4_film_keeps_colours_duration_and_sound(tmp_path: Path):
    """Check codec, size, frame rate, durations, colour space and colours."""
    ffmpeg, ffprobe = find_encoder(), shutil.which("ffprobe")
    if ffmpeg is None or ffprobe is None:
        pytest.skip("ffmpeg and ffprobe are not installed: apt-get install ffmpeg")
    path, voice = tmp_path / "x.mp4", tmp_path / "voice.wav"
    with wave.open(str(voice), "wb") as sound:
        sound.setparams((1, 2, 16000, 0, "NONE", ""))
        sound.writeframes(bytes(2 * 8000))
    drawn = np.zeros((46, 62, 3), dtype=np.uint8)
    drawn[:, :31], drawn[:, 31:] = (220, 60, 40), (40, 130, 210)
    with open_film(path, (62, 46), rate=30.0, sound=voice) as film:
        for _ in range(15):
            film.write(drawn, None, 33)
    words = [ffprobe, "-v", "error", "-count_frames", "-show_streams", "-of", "json", str(path)]
    seen, heard = json.loads(subprocess.run(words, capture_output=True, check=True).stdout)["streams"]
    assert (seen["codec_name"], seen["pix_fmt"], heard["codec_name"]) == ("h264", "yuv420p", "aac")
    assert (seen["width"], seen["height"], seen["nb_read_frames"], seen["r_frame_rate"]) == (62, 46, "15", "30/1")
    assert float(seen["duration"]) == pytest.approx(0.5)
    assert float(heard["duration"]) == pytest.approx(0.5, abs=0.07)
    assert seen["color_space"] == "bt709"
    words = [ffmpeg, "-v", "error", "-i", str(path), "-frames:v", "1", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    shown = np.frombuffer(subprocess.run(words, capture_output=True, check=True).stdout, dtype=np.uint8)
    apart = np.abs(shown.reshape(drawn.shape).astype(int) - drawn)
    assert np.median(apart) < 4


def test_error_for_a_missing_encoder_gives_the_command_that_installs_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(EncodingError, match="pip install imageio-ffmpeg, or install ffmpeg"):
        open_film(tmp_path / "x.mp4", PICTURE_SIZE, rate=30.0)

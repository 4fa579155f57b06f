import sys
import wave
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.action_units import ACTION_UNITS
from kinesic.face.display import DisplayError
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT_PRESET
from kinesic.face.show import files
from kinesic.face.show.files import SideFilm, check_film, join_frames, require_encoder, save_film, save_picture
from kinesic.face.show.sheet import LABEL_HEIGHT, PICTURE_KINDS, UNIT_GAP, UNITS_PER_ROW, draw_units_sheet
from kinesic.files import film_file

BLACK_PICTURE = np.zeros((8, 8, 3), dtype=np.uint8)


def test_saved_face_picture_is_read_back(tmp_path: Path):
    pixels = np.random.default_rng(0).integers(0, 256, (8, 12, 3), dtype=np.uint8)
    save_picture(pixels, tmp_path / "x.png")
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "x.png")), pixels)


def test_saved_film_has_all_frames(tmp_path: Path):
    frames = [np.full((8, 8, 3), 40 * k, dtype=np.uint8) for k in range(5)]
    save_film(frames, tmp_path / "x.webp", rate=20.0)
    with Image.open(tmp_path / "x.webp") as film:
        assert film.n_frames == 5


@pytest.mark.parametrize("name", ["x.gif", "x", "nowhere/x.png"])
def test_error_for_an_unwritable_face_picture_names_its_path(tmp_path: Path, name: str):
    with pytest.raises(DisplayError, match=name):
        save_picture(BLACK_PICTURE, tmp_path / name)


@pytest.mark.parametrize("name", ["x.gif", "x", "nowhere/x.webp"])
def test_error_for_an_unwritable_face_film_names_its_path(tmp_path: Path, name: str):
    with pytest.raises(DisplayError, match=name):
        save_film([BLACK_PICTURE], tmp_path / name, rate=24.0)


def test_frame_times_of_a_film_do_not_accumulate_rounding_errors(tmp_path: Path):
    """Use frame periods that are not whole milliseconds."""
    frames = [np.full((8, 8, 3), 3 * k, dtype=np.uint8) for k in range(60)]
    save_film(frames, tmp_path / "x.webp", rate=24.0)
    total = 0
    with Image.open(tmp_path / "x.webp") as film:
        for k in range(film.n_frames):
            film.seek(k)
            film.load()
            total += film.info["duration"]
    assert total == 2500


def test_film_saved_as_a_picture_strip_shows_its_frames_in_rows():
    frames = [np.full((700, 700, 3), 10 * k, dtype=np.uint8) for k in range(3)]
    pixels = join_frames(frames)
    assert pixels.shape == (1400, 1400, 3)
    assert [pixels[100, 100, 0], pixels[100, 800, 0], pixels[800, 100, 0], pixels[800, 800, 0]] == [0, 10, 20, 0]


def test_mp4_film_contains_h264_video_and_aac_sound(tmp_path: Path):
    try:
        require_encoder()
    except DisplayError as error:
        pytest.skip(str(error))
    with wave.open(str(tmp_path / "x.wav"), "wb") as sound:
        sound.setparams((1, 2, 22050, 0, "NONE", ""))
        sound.writeframes(bytes(22050))
    frames = [np.full((33, 31, 3), 20 * k, dtype=np.uint8) for k in range(12)]
    save_film(frames, tmp_path / "x.mp4", rate=24.0, sound=tmp_path / "x.wav")
    data = (tmp_path / "x.mp4").read_bytes()
    assert data[4:8] == b"ftyp"
    assert b"avc1" in data
    assert b"mp4a" in data


def test_error_for_a_missing_film_encoder_names_the_packages_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setattr(film_file.shutil, "which", lambda name: None)
    with pytest.raises(DisplayError, match=r"pip install .*imageio-ffmpeg") as caught:
        check_film(tmp_path / "x.mp4")
    check_film(tmp_path / "x.webp")
    assert "\n" not in str(caught.value)


def test_action_unit_sheet_has_four_pictures_per_unit(drawable: None):
    with Portrait(size=(40, 40), preset=DRAFT_PRESET) as portrait:
        pixels = draw_units_sheet(portrait, units=[1, 4, 12, 26])
    assert pixels.shape == (
        2 * (40 + LABEL_HEIGHT) + LABEL_HEIGHT,
        UNITS_PER_ROW * (len(PICTURE_KINDS) * 40 + UNIT_GAP) - UNIT_GAP,
        3,
    )
    assert len(ACTION_UNITS) <= 13 * UNITS_PER_ROW


@pytest.mark.parametrize("height", [16, 64])
def test_saved_film_has_the_width_and_height_of_its_frames(tmp_path: Path, height: int):
    save_film([np.zeros((height, 32, 3), dtype=np.uint8)], tmp_path / "x.webp", rate=10.0)
    with Image.open(tmp_path / "x.webp") as film:
        assert film.size == (32, height)


def test_png_film_has_all_frames_in_one_picture(tmp_path: Path):
    frames = [np.full((2, 3, 3), 40 * k, dtype=np.uint8) for k in range(2)]
    save_film(iter(frames), tmp_path / "x.PNG", rate=10.0)
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "x.PNG")), np.concatenate(frames, axis=1))


@pytest.mark.parametrize(("once", "loops"), [({}, 0), ({"once": True}, 1)])
def test_saved_webp_film_loops_unless_the_caller_asks_for_one_showing(
    tmp_path: Path, once: dict[str, bool], loops: int
):
    save_film([BLACK_PICTURE, BLACK_PICTURE + 255], tmp_path / "x.webp", rate=10.0, **once)
    with Image.open(tmp_path / "x.webp") as film:
        assert film.info["loop"] == loops


def test_webp_films_have_the_default_quality_and_compression_effort(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Detect unintended changes of file size and writing time."""
    asked: list[dict[str, object]] = []
    webp = film_file.WebpFilm
    monkeypatch.setattr(files, "WebpFilm", lambda *places, **options: asked.append(options) or webp(*places, **options))
    save_film([BLACK_PICTURE], tmp_path / "x.webp", rate=10.0)
    assert asked == [{"quality": 86, "method": 1, "in_parts": False, "once": False}]


def test_film_encoder_error_is_raised_as_a_display_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    opened: list[tuple[object, ...]] = []

    def fail_to_open(*places: object, **options: object) -> None:
        opened.append((*places, options))
        raise film_file.EncodingError("ffmpeg ended with 1")

    monkeypatch.setattr(files, "find_encoder", lambda: "ffmpeg")
    monkeypatch.setattr(files, "Mp4Film", fail_to_open)
    path = tmp_path / "x.mp4"
    with pytest.raises(DisplayError, match="ffmpeg ended with 1"):
        save_film([np.zeros((8, 6, 3), np.uint8)], path, rate=10.0, sound=tmp_path / "x.wav")
    assert opened == [(path, (6, 8), {"rate": 10.0, "sound": tmp_path / "x.wav"})]
    assert require_encoder() == "ffmpeg"


@pytest.mark.parametrize(
    ("count", "size", "shape"),
    [
        (1, (4, 3), (3, 4)),
        (4, (512, 8), (8, 2048)),
        (5, (512, 8), (16, 2048)),
        (4, (513, 8), (16, 1539)),
        (2, (4096, 8), (16, 4096)),
    ],
)
def test_picture_strip_is_up_to_2048_pixels_wide(count: int, size: tuple[int, int], shape: tuple[int, int]):
    frames = [np.full((size[1], size[0], 3), k + 1, dtype=np.uint8) for k in range(count)]
    assert join_frames(frames).shape == (*shape, 3)


def test_film_of_the_body_is_scaled_to_the_height_of_the_face(tmp_path: Path):
    shades = (0, 200)
    save_film([np.full((20, 30, 3), shade, np.uint8) for shade in shades], tmp_path / "x.webp", rate=10.0)
    film = SideFilm(tmp_path / "x.webp", 8)
    for time, shade in zip((0.0, 0.15), shades, strict=True):
        picture = film.at(time)
        assert picture.shape == (8, 12, 3)
        assert picture.mean() == pytest.approx(shade, abs=3)


def test_body_film_that_is_no_film_is_named_in_the_error(tmp_path: Path):
    (tmp_path / "x.webp").write_text("nothing")
    with pytest.raises(DisplayError, match=r"x\.webp: not a film"):
        SideFilm(tmp_path / "x.webp", 8)

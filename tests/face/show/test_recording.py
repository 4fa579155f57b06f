from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.controller.play import play
from kinesic.face.display import DisplayError
from kinesic.face.render.camera import CLOSE_CAMERA, STUDIO_LIGHTS, Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT_PRESET, NORMAL_PRESET
from kinesic.face.show import recording
from kinesic.face.show.recording import FaceRecording, PortraitSettings

NO_ANGLES = np.zeros(0)
SMALL_SETTINGS = PortraitSettings(preset=DRAFT_PRESET, size=(32, 32))


def opening(seconds: float, angles: np.ndarray = NO_ANGLES) -> list[Command]:
    """Return 100 commands per second in which the mouth opens."""
    count = round(100 * seconds) + 1
    return [Command(k / 100, angles, angles, angles, angles, {"26": k / count}) for k in range(count)]


def test_face_film_of_a_performance_has_the_requested_frame_rate(drawable: None, tmp_path: Path):
    path = tmp_path / "x.webp"
    play(opening(1.0), FaceRecording(path, rate=20.0, look=SMALL_SETTINGS))
    with Image.open(path) as film:
        assert film.n_frames == 21
        film.load()
        assert film.info["duration"] == 50


def test_filmed_head_turns_with_the_robot(drawable: None, tmp_path: Path):
    robot = Robot.load("upper22")
    rotated = robot.skeleton.rest.copy()
    rotated[[k for k, name in enumerate(robot.skeleton.names) if name.endswith("torsion")]] = 0.4
    faces = []
    for name, angles in (("ahead", robot.skeleton.rest), ("aside", rotated)):
        play(opening(0.0, angles), FaceRecording(tmp_path / f"{name}.png", robot, look=SMALL_SETTINGS))
        faces.append(np.asarray(Image.open(tmp_path / f"{name}.png")).astype(int))
    assert np.abs(faces[0] - faces[1]).mean() > 2.0


def test_face_film_of_a_long_performance_has_a_lower_frame_rate(
    drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(recording, "MAX_PICTURES", 10)
    play(
        opening(1.0),
        FaceRecording(tmp_path / "x.webp", rate=20.0, look=PortraitSettings(preset=DRAFT_PRESET, size=(16, 16))),
    )
    with Image.open(tmp_path / "x.webp") as film:
        assert film.n_frames == 7
        film.load()
        assert film.info["duration"] == 150


def test_unchanged_face_is_drawn_once_in_a_recorded_film(
    drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    drawn: list[dict[str, float]] = []

    def draw(portrait: Portrait, units: dict[str, float], *more: object, **others: object) -> np.ndarray:
        drawn.append(units)
        return np.full((32, 32, 3), round(255 * units["26"]), dtype=np.uint8)

    monkeypatch.setattr(Portrait, "draw", draw)
    held = [
        Command(k / 20, NO_ANGLES, NO_ANGLES, NO_ANGLES, NO_ANGLES, {"26": 0.5 if k < 8 else 1.0}) for k in range(12)
    ]
    play(held, FaceRecording(tmp_path / "x.webp", rate=20.0, look=SMALL_SETTINGS))
    assert drawn == [{"26": 0.5}, {"26": 1.0}]
    with Image.open(tmp_path / "x.webp") as film:
        shown = []
        for k in range(film.n_frames):
            film.seek(k)
            film.load()
            shown.append(film.info["duration"])
    assert shown == [400, 200]


def test_filmed_pupils_widen_while_the_eyes_are_closed(drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Expect pupils that narrow slowly after the eyes open."""
    wide: list[float] = []

    def draw(portrait: Portrait, *given: object, pupil: float, **others: object) -> np.ndarray:
        wide.append(pupil)
        return np.zeros((*portrait.size[::-1], 3), np.uint8)

    monkeypatch.setattr(Portrait, "draw", draw)
    shut = [Command(k / 20, NO_ANGLES, NO_ANGLES, NO_ANGLES, NO_ANGLES, {"43": float(10 <= k < 30)}) for k in range(60)]
    play(shut, FaceRecording(tmp_path / "x.webp", rate=20.0, look=SMALL_SETTINGS))
    previous, narrowest, widest = wide[0], wide[-1], max(wide)
    assert widest > 1.1 * previous
    assert narrowest == pytest.approx(previous, rel=0.02)
    assert len(wide) > 30  # the lid changes alone would give three pictures


def test_empty_performance_writes_no_film(tmp_path: Path):
    play([], FaceRecording(tmp_path / "x.webp"))
    assert not (tmp_path / "x.webp").exists()


def test_unknown_film_format_is_rejected_immediately(tmp_path: Path):
    with pytest.raises(DisplayError, match=r"x\.gif: a film of the face must end in \.webp"):
        FaceRecording(tmp_path / "x.gif")


def test_face_film_starts_at_the_time_of_the_first_command(drawable: None, tmp_path: Path):
    film = FaceRecording(tmp_path / "x.webp", rate=20.0, look=SMALL_SETTINGS)
    for command in opening(0.5):
        film.write(Command(command.time + 7.0, *[NO_ANGLES] * 4, command.face))
    film.close()
    with Image.open(tmp_path / "x.webp") as pictures:
        assert pictures.n_frames == 11


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, object]]:
    """List the arguments of each picture that would be drawn."""
    pictures: list[dict[str, object]] = []

    class FakePortrait:
        def __init__(self, variant: str, **options: object) -> None:
            self._options = {"variant": variant, **options}

        def __enter__(self) -> "FakePortrait":
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def draw(self, units: dict[str, float], camera: Camera, **options: object) -> np.ndarray:
            pictures.append({"units": units, "camera": camera, **self._options, **options})
            return np.full((8, 8, 3), len(pictures), np.uint8)

    monkeypatch.setattr(recording, "Portrait", FakePortrait)
    return pictures


def still(times: Iterable[float]) -> list[Command]:
    """Return commands at given times, each with a different mouth opening."""
    return [Command(time, *[NO_ANGLES] * 4, {"26": round(0.01 * k, 2)}) for k, time in enumerate(times)]


def test_face_is_filmed_with_the_default_settings(drawn, tmp_path: Path):
    play(still([0.0]), FaceRecording(tmp_path / "x.webp"))
    (picture,) = drawn
    assert (picture["variant"], picture["preset"], picture["size"]) == ("female", NORMAL_PRESET, (384, 384))
    assert picture["gain"] == 1.0
    assert picture["lights"] == STUDIO_LIGHTS
    assert picture["camera"] == replace(CLOSE_CAMERA, turn=(0.0, 0.0, 0.0))


def test_dim_scene_widens_the_filmed_pupils(drawn, tmp_path: Path):
    for light in (1.0, 0.25):
        play(still([0.0]), FaceRecording(tmp_path / "x.webp", look=PortraitSettings(light=light)))
    bright, dim = drawn
    assert dim["lights"] == STUDIO_LIGHTS.scaled(0.25)
    assert dim["pupil"] > bright["pupil"]
    assert bright["pupil"] == round(bright["pupil"], 5) != round(bright["pupil"], 4)


def test_default_face_film_has_25_pictures_per_second_despite_rounded_times(drawn, tmp_path: Path):
    times = [3.0, 3.0 + 1e-9, 3.04 - 2e-6, 3.04 - 5e-7, 3.06, 3.08 + 1e-3]
    play(still(times), FaceRecording(tmp_path / "x.webp"))
    assert [picture["units"]["26"] for picture in drawn] == [0.0, 0.03, 0.05]


@pytest.mark.parametrize(("limit", "count"), [(4, 4), (3, 2)])
def test_face_film_omits_pictures_only_above_the_maximum_number(drawn, tmp_path: Path, monkeypatch, limit, count):
    assert recording.MAX_PICTURES == 3600
    monkeypatch.setattr(recording, "MAX_PICTURES", limit)
    shares: list[float] = []
    film = FaceRecording(tmp_path / "x.webp", rate=10.0, progress=shares.append)
    play(still([0.0, 0.1, 0.2, 0.3]), film)
    assert shares == pytest.approx([(k + 1) / count for k in range(count)])
    assert len(drawn) == count


def test_pupils_adapt_by_the_time_between_pictures_and_not_at_the_first_picture(drawn, tmp_path: Path, monkeypatch):
    elapsed: list[float] = []
    monkeypatch.setattr(recording.Pupils, "follow", lambda self, light, passed: elapsed.append(passed) or 0.003)
    play(still([5.0, 5.1, 5.3]), FaceRecording(tmp_path / "x.webp", rate=10.0))
    assert elapsed == pytest.approx([0.0, 0.1, 0.2])


def test_face_film_is_written_at_context_exit_unless_an_exception_was_raised(drawn, tmp_path: Path):
    path = tmp_path / "x.webp"

    def fail() -> None:
        with FaceRecording(path) as film:
            film.write(still([0.0])[0])
            raise RuntimeError("lost")

    with pytest.raises(RuntimeError, match="lost"):
        fail()
    assert not path.exists()
    with FaceRecording(path) as film:
        film.write(still([0.0])[0])
        assert not path.exists()
    assert path.exists()
    film.close()
    assert len(drawn) == 1

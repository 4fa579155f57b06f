from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.controller.play import play
from kinesic.face.display import DisplayError
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT
from kinesic.face.show import recording
from kinesic.face.show.recording import FaceRecording, PortraitSettings

NONE = np.zeros(0)
LOOK = PortraitSettings(preset=DRAFT, size=(32, 32))


def opening(seconds: float, angles: np.ndarray = NONE) -> list[Command]:
    """The mouth opens, at 100 commands a second."""
    count = round(100 * seconds) + 1
    return [Command(k / 100, angles, angles, angles, angles, {"26": k / count}) for k in range(count)]


def test_a_performance_becomes_a_film_at_its_rate(drawable: None, tmp_path: Path):
    path = tmp_path / "x.webp"
    play(opening(1.0), FaceRecording(path, rate=20.0, look=LOOK))
    with Image.open(path) as film:
        assert film.n_frames == 21
        film.load()
        assert film.info["duration"] == 50


def test_the_head_turns_with_the_robot(drawable: None, tmp_path: Path):
    robot = Robot.load("upper22")
    turned = robot.skeleton.rest.copy()
    turned[[k for k, name in enumerate(robot.skeleton.names) if name.endswith("torsion")]] = 0.4
    faces = []
    for name, angles in (("ahead", robot.skeleton.rest), ("aside", turned)):
        play(opening(0.0, angles), FaceRecording(tmp_path / f"{name}.png", robot, look=LOOK))
        faces.append(np.asarray(Image.open(tmp_path / f"{name}.png")).astype(int))
    assert np.abs(faces[0] - faces[1]).mean() > 2.0


def test_a_long_performance_has_fewer_pictures(drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(recording, "MOST_PICTURES", 10)
    play(
        opening(1.0), FaceRecording(tmp_path / "x.webp", rate=20.0, look=PortraitSettings(preset=DRAFT, size=(16, 16)))
    )
    with Image.open(tmp_path / "x.webp") as film:
        assert film.n_frames == 7
        film.load()
        assert film.info["duration"] == 150


def test_a_face_that_holds_still_is_drawn_once(drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    drawn: list[dict[str, float]] = []

    def draw(portrait: Portrait, units: dict[str, float], *more: object, **others: object) -> np.ndarray:
        drawn.append(units)
        return np.full((32, 32, 3), round(255 * units["26"]), dtype=np.uint8)

    monkeypatch.setattr(Portrait, "draw", draw)
    held = [Command(k / 20, NONE, NONE, NONE, NONE, {"26": 0.5 if k < 8 else 1.0}) for k in range(12)]
    play(held, FaceRecording(tmp_path / "x.webp", rate=20.0, look=LOOK))
    assert drawn == [{"26": 0.5}, {"26": 1.0}]
    with Image.open(tmp_path / "x.webp") as film:
        shown = []
        for k in range(film.n_frames):
            film.seek(k)
            film.load()
            shown.append(film.info["duration"])
    assert shown == [400, 200]


def test_pupils_follow_the_light_that_lids_let_in(drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """They widen while the eyes are shut, and narrow again when they open, in more pictures than the lids take."""
    wide: list[float] = []

    def draw(portrait: Portrait, *given: object, pupil: float, **others: object) -> np.ndarray:
        wide.append(pupil)
        return np.zeros((*portrait.size[::-1], 3), np.uint8)

    monkeypatch.setattr(Portrait, "draw", draw)
    shut = [Command(k / 20, NONE, NONE, NONE, NONE, {"43": float(10 <= k < 30)}) for k in range(60)]
    play(shut, FaceRecording(tmp_path / "x.webp", rate=20.0, look=LOOK))
    before, narrowest, widest = wide[0], wide[-1], max(wide)
    assert widest > 1.1 * before
    assert narrowest == pytest.approx(before, rel=0.02)
    assert len(wide) > 30  # two changes of the lids alone would be three pictures


def test_nothing_performed_is_no_film(tmp_path: Path):
    play([], FaceRecording(tmp_path / "x.webp"))
    assert not (tmp_path / "x.webp").exists()


def test_an_unknown_format_is_refused_at_once(tmp_path: Path):
    with pytest.raises(DisplayError, match=r"x\.gif: a film of the face ends in \.webp"):
        FaceRecording(tmp_path / "x.gif")

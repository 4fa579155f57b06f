import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from kinesic.body.robot import Robot
from kinesic.sim import film as films
from kinesic.sim import gl
from kinesic.sim.film import FilmError, film, write_still
from kinesic.sim.scene_style import COLOURS

ROBOT = Robot.load()
REST = ROBOT.skeleton.rest
RAISED = REST.copy()
RAISED[ROBOT.skeleton.joint("r_shoulder_flexion")] = 2.6


@pytest.fixture(scope="module")
def drawing():
    """Asked only when a film is wanted: the answer takes a process of its own."""
    if why := gl.opengl_fault():
        pytest.skip(why)


draws = pytest.mark.usefixtures("drawing")


def of_colour(picture, colour):
    """Pixels (k, 2) row and column whose hue is that of a colour."""
    shade = picture[..., :3].astype(float)
    shade /= np.maximum(np.linalg.norm(shade, axis=-1, keepdims=True), 1.0)
    wanted = np.array(colour[:3]) / np.linalg.norm(colour[:3])
    return np.argwhere(shade @ wanted > 0.985)


@draws
def test_a_film_has_the_motions_length_and_moves(tmp_path):
    times = np.linspace(0.0, 1.0, 101)
    angles = REST + np.outer(times, RAISED - REST)
    path = tmp_path / "film.webp"
    film(ROBOT, times, angles, path, size=(160, 120), rate=8)
    with Image.open(path) as seen:
        assert (seen.format, seen.size, seen.n_frames) == ("WEBP", (160, 120), 9)
        pictures = []
        for k in range(seen.n_frames):
            seen.seek(k)
            pictures.append(np.array(seen.convert("RGB"), dtype=float))
            assert seen.info["duration"] == 125
    assert np.abs(pictures[-1] - pictures[0]).max() > 100


@draws
def test_a_long_motion_is_filmed_at_a_lower_rate(tmp_path, monkeypatch):
    monkeypatch.setattr(films, "MOST_PICTURES", 5)
    path = tmp_path / "film.webp"
    film(ROBOT, np.array([0.0, 10.0]), np.array([REST, RAISED]), path, size=(80, 60))
    with Image.open(path) as seen:
        assert seen.n_frames == 6
        seen.load()
        assert seen.info["duration"] == 2000


@draws
def test_a_still_shows_the_whole_upper_body_and_its_facing(tmp_path):
    heights = {}
    for name, posture in (("rest", REST), ("raised", RAISED)):
        path = tmp_path / f"{name}.png"
        write_still(ROBOT, posture, path)
        with Image.open(path) as seen:
            assert (seen.format, seen.size) == ("PNG", (480, 360))
            picture = np.array(seen)
        hands = {
            side: of_colour(picture, colour) for side, colour in (("l", COLOURS["l_hand"]), ("r", COLOURS["r_hand"]))
        }
        for pixels in hands.values():
            assert len(pixels) > 100
            assert pixels.min() > 2
            assert (pixels.max(axis=0) < np.array([357, 477])).all()
        assert hands["l"][:, 1].mean() > hands["r"][:, 1].mean(), "seen from the front, its left is at our right"
        heights[name] = hands["r"][:, 0].mean()
    assert heights["raised"] < heights["rest"] - 100


def test_without_opengl_the_line_that_mends_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(films, "opengl_fault", lambda: f"OpenGL is missing (libEGL.so.1): {gl.APT_LINE}")
    with pytest.raises(FilmError, match="apt-get install libegl1"):
        write_still(ROBOT, REST, tmp_path / "never.png")
    assert not (tmp_path / "never.png").exists()


@draws
def test_a_mujoco_imported_too_early_is_named(tmp_path):
    program = (
        "import warnings; warnings.simplefilter('ignore')\n"
        "import mujoco\n"
        "from pathlib import Path\n"
        "from kinesic.body.robot import Robot\n"
        "from kinesic.sim.film import FilmError, write_still\n"
        "robot = Robot.load()\n"
        "try:\n"
        f"    write_still(robot, robot.skeleton.rest, Path({str(tmp_path / 'early.png')!r}))\n"
        "    print('drawn')\n"
        "except FilmError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, env={"PATH": "/usr/bin:/bin"}
    )
    assert "import kinesic.sim before mujoco" in done.stdout or done.stdout.strip() == "drawn", done.stderr


def test_times_and_postures_must_agree(tmp_path):
    with pytest.raises(ValueError, match="1 postures at 2 times"):
        film(ROBOT, np.array([0.0, 1.0]), REST[None], tmp_path / "never.webp")
    with pytest.raises(ValueError, match="at least 1"):
        film(ROBOT, np.empty(0), np.empty((0, 22)), tmp_path / "never.webp")

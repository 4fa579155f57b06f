import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from kinesic.body.robot import Robot
from kinesic.files.caption_band import caption_box
from kinesic.files.film_reader import FilmReader
from kinesic.sim import film as films
from kinesic.sim import gl
from kinesic.sim.film import FilmError, film, write_still
from kinesic.sim.filming.drawn_face import paint_face
from kinesic.sim.filming.face_screen import build_face_screen
from kinesic.sim.filming.framing import find_capsule_balls, find_motion_view, project_points
from kinesic.sim.part_colours import PART_COLOURS
from kinesic.sim.scene_layout import find_scene_view

ROBOT = Robot.load()
REST_POSTURE = ROBOT.skeleton.rest
RAISED_POSTURE = REST_POSTURE.copy()
RAISED_POSTURE[ROBOT.skeleton.joint("r_shoulder_flexion")] = 2.6


@pytest.fixture(scope="module")
def needs_opengl():
    """Skip the test if OpenGL cannot draw, as tested by a process."""
    if why := gl.opengl_fault():
        pytest.skip(why)


draws = pytest.mark.usefixtures("needs_opengl")


def find_pixels(picture, colour):
    """Return rows and columns (k, 2) of pixels with the hue of a colour."""
    shade = picture[..., :3].astype(float)
    shade /= np.maximum(np.linalg.norm(shade, axis=-1, keepdims=True), 1.0)
    wanted = np.array(colour[:3]) / np.linalg.norm(colour[:3])
    return np.argwhere(shade @ wanted > 0.985)


@draws
def test_film_has_the_duration_of_the_motion_and_shows_the_motion(tmp_path):
    times = np.linspace(0.0, 1.0, 101)
    angles = REST_POSTURE + np.outer(times, RAISED_POSTURE - REST_POSTURE)
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


def read_pictures(path):
    """Return the pictures of a film and their durations [ms]."""
    with Image.open(path) as seen:
        pictures, shown = [], []
        for k in range(seen.n_frames):
            seen.seek(k)
            pictures.append(np.array(seen.convert("RGB"), dtype=float))
            shown.append(seen.info["duration"])
    return pictures, shown


@draws
def test_each_film_picture_shows_the_face_at_its_time(tmp_path):
    """The head nods while its screen gets brighter with time."""
    times, path = np.linspace(0.0, 0.6, 61), tmp_path / "film.webp"
    nodding = np.repeat(REST_POSTURE[None], len(times), axis=0)
    nodding[:, ROBOT.skeleton.joint("skullbase_tilt")] += 0.1 * np.sin(8 * times)
    asked = []

    def face(k, time):
        asked.append((k, time))
        return np.full((240, 320, 3), 40 + 20 * k, dtype=np.uint8)

    film(ROBOT, times, nodding, path, size=(320, 180), rate=15, faces=face)
    assert [k for k, _ in asked] == list(range(10))
    assert [time for _, time in asked] == pytest.approx([k / 15 for k in range(10)])
    pictures, shown = read_pictures(path)
    assert sum(shown) == pytest.approx(1000 * 10 / 15, abs=1), "as long as the motion, and the last picture"
    screen = project_points(
        find_motion_view(ROBOT, nodding, aspect=16 / 9), screen_middle(REST_POSTURE), size=(320, 180)
    )[:2]
    column, row = np.round(screen).astype(int)
    lights = [picture[row - 2 : row + 3, column - 2 : column + 3].mean() for picture in pictures]
    assert np.diff(lights) == pytest.approx(np.full(9, np.mean(np.diff(lights))), abs=6)
    assert lights[-1] - lights[0] > 120


@draws
def test_opening_mouth_is_visible_on_the_head_screen(tmp_path):
    times, path = np.array([0.0, 0.2]), tmp_path / "film.webp"
    mouths = ({}, {"26": 0.9}, {})
    film(
        ROBOT,
        times,
        np.stack([REST_POSTURE, REST_POSTURE]),
        path,
        size=(640, 360),
        rate=10,
        faces=lambda k, t: paint_face(mouths[k]),
    )
    (shut, opened, again), _ = read_pictures(path)
    moved = np.argwhere(np.abs(opened - shut).max(axis=2) > 40)
    column, row = project_points(
        find_motion_view(ROBOT, REST_POSTURE[None], aspect=16 / 9), screen_middle(REST_POSTURE), size=(640, 360)
    )[:2]
    assert len(moved) > 10
    assert np.abs(moved - [row, column]).max() < 25, "and nowhere else"
    assert np.abs(again - shut).mean() < 1.0


@draws
def test_captions_are_shown_while_words_are_spoken(tmp_path):
    times, path = np.linspace(0.0, 1.0, 11), tmp_path / "film.webp"
    film(ROBOT, times, np.stack([REST_POSTURE] * 11), path, size=(320, 180), rate=10, spoken=[(0.3, 0.6, "Hello")])
    reader = FilmReader(path)
    left, top, right, low = caption_box("Hello", (320, 180))
    bands = np.stack([reader.at(0.1 * k + 0.05)[top:low, left:right].astype(float) for k in range(11)])
    seen = (np.abs(bands - bands[0]).mean(axis=(1, 2, 3)) > 30).tolist()
    assert seen == [3 <= k < 6 for k in range(11)]


def screen_middle(posture):
    """Return the centre (3,) [m] of the head screen in the world."""
    screen = build_face_screen(ROBOT)
    frames, k = ROBOT.skeleton.frames(posture), ROBOT.skeleton.segment(screen.segment)
    return frames.origins[k] + frames.rotations[k] @ screen.picture.places[0]


@pytest.mark.soak
@draws
def test_long_motion_is_filmed_at_a_lower_rate(tmp_path, monkeypatch):
    monkeypatch.setattr(films, "MAX_FILM_PICTURES", 5)
    path = tmp_path / "film.webp"
    film(ROBOT, np.array([0.0, 10.0]), np.array([REST_POSTURE, RAISED_POSTURE]), path, size=(80, 60))
    with Image.open(path) as seen:
        assert seen.n_frames == 6
        seen.load()
        assert seen.info["duration"] == 2000


@draws
def test_still_shows_both_hands_within_the_picture_from_the_front(tmp_path):
    heights = {}
    for name, posture in (("rest", REST_POSTURE), ("raised", RAISED_POSTURE)):
        path = tmp_path / f"{name}.png"
        write_still(ROBOT, posture, path)
        with Image.open(path) as seen:
            assert (seen.format, seen.size) == ("PNG", (480, 360))
            picture = np.array(seen)
        hands = {
            side: find_pixels(picture, colour)
            for side, colour in (("l", PART_COLOURS["l_hand"]), ("r", PART_COLOURS["r_hand"]))
        }
        for pixels in hands.values():
            assert len(pixels) > 100
            assert pixels.min() > 2
            assert (pixels.max(axis=0) < np.array([357, 477])).all()
        assert hands["l"][:, 1].mean() > hands["r"][:, 1].mean(), "seen from the front, its left is at our right"
        heights[name] = hands["r"][:, 0].mean()
    assert heights["raised"] < heights["rest"] - 100


def test_error_without_opengl_names_the_install_command(tmp_path, monkeypatch):
    monkeypatch.setattr(films, "opengl_fault", lambda: f"OpenGL is missing (libEGL.so.1): {gl.INSTALL_COMMAND}")
    with pytest.raises(FilmError, match="apt-get install libegl1"):
        write_still(ROBOT, REST_POSTURE, tmp_path / "never.png")
    assert not (tmp_path / "never.png").exists()


@draws
def test_error_names_an_early_mujoco_import_if_it_prevents_drawing(tmp_path):
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


def test_film_rejects_different_numbers_of_times_and_postures(tmp_path):
    with pytest.raises(ValueError, match="1 postures at 2 times"):
        film(ROBOT, np.array([0.0, 1.0]), REST_POSTURE[None], tmp_path / "never.webp")
    with pytest.raises(ValueError, match="at least 1"):
        film(ROBOT, np.empty(0), np.empty((0, 22)), tmp_path / "never.webp")


@pytest.mark.soak
@draws
def test_no_servo_protrudes_visibly_from_the_forearms(tmp_path):
    """Compare pixels along the forearms with the brightness of their paint."""
    size, path = (1280, 720), tmp_path / "still.png"
    bare = replace(ROBOT, path=tmp_path / "own.toml")  # has no shell file next to it
    write_still(bare, REST_POSTURE, path, size=size)
    with Image.open(path) as seen:
        picture = np.asarray(seen.convert("L"), dtype=float)
    for side in ("l", "r"):
        forearm = ROBOT.skeleton.segments[ROBOT.arm(side).elbow].name
        places, radii = find_capsule_balls(ROBOT, REST_POSTURE[None], [forearm])
        start, end = project_points(find_scene_view(ROBOT), places, size=size)[0, :2]
        along = (end - start)[:2] / np.linalg.norm((end - start)[:2])
        shares, across = np.linspace(0.1, 0.8, 60), np.linspace(-0.6, 0.6, 25) * start[2] * radii[0]
        points = start[:2] + shares[:, None, None] * (end - start)[:2]
        points = points + across[None, :, None] * np.array([-along[1], along[0]])
        columns, rows = np.round(points).astype(int).reshape(-1, 2).T
        assert picture[rows, columns].min() > 110

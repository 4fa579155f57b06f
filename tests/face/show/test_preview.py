"""Tests of the face preview, which draws in a separate process."""

import multiprocessing
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.command import NO_FACE, Command
from kinesic.body.robot import Robot
from kinesic.controller.play import play
from kinesic.face.display import DisplayError, open_offscreen_context
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT_PRESET
from kinesic.face.show.controls import Controls
from kinesic.face.show.files import SideFilm, save_film
from kinesic.face.show.preview import Preview
from kinesic.face.show.preview_settings import PreviewSettings
from kinesic.face.show.process import make_painter, run_preview
from kinesic.face.show.shared_command import SharedCommand, ShownFace
from kinesic.face.show.window import has_display

pytestmark = pytest.mark.realtime

SMALL_SETTINGS = PreviewSettings(preset="draft", side=32)
NO_ANGLES = np.zeros(0)


def command(time: float, face: Mapping[str, float] = NO_FACE, angles: np.ndarray = NO_ANGLES) -> Command:
    return Command(time, angles, angles, angles, angles, face)


def shared() -> SharedCommand:
    return SharedCommand(multiprocessing.get_context("spawn"))


class Screen:
    """Screen that closes after some pictures."""

    def __init__(self, pictures: int = 1000, keys: list[str] | None = None) -> None:
        self.titles: list[str] = []
        self._most, self._keys = pictures, keys or []

    @property
    def closed(self) -> bool:
        return len(self.titles) >= self._most

    def show(self, pixels: np.ndarray, title: str) -> None:
        self.titles.append(title)

    def pressed(self) -> list[str]:
        keys, self._keys = self._keys, []
        return keys


def test_preview_shared_memory_contains_the_newest_face():
    here = shared()
    assert here.read() == ShownFace(0, 0.0, (0.0, 0.0, 0.0), {})
    for number in (1, 2):
        assert here.write(ShownFace(number, 0.5, (0.1, 0.2, 0.3), {"12": 0.4, "26": 0.5}))
    assert here.read() == ShownFace(2, 0.5, (0.1, 0.2, 0.3), {"L12": 0.4, "R12": 0.4, "26": 0.5})


def test_preview_writer_does_not_wait_while_the_shared_memory_is_locked():
    here = shared()
    with here._lock:
        assert not here.write(ShownFace(1, 0.0, (0.0, 0.0, 0.0), {}))
    assert here.write(ShownFace(2, 0.0, (0.0, 0.0, 0.0), {}))


@pytest.mark.parametrize(
    ("units", "says"),
    [({"99": 1.0}, "no action unit 99"), ({"12": 1.5}, "action unit 12 is 1.5; intensities go from 0 to 1")],
)
def test_invalid_action_unit_or_intensity_in_the_preview_gives_a_one_line_error(units: Mapping[str, float], says: str):
    with pytest.raises(DisplayError, match=says) as caught:
        shared().write(ShownFace(1, 0.0, (0.0, 0.0, 0.0), units))
    assert "\n" not in str(caught.value)


def test_preview_draws_the_last_face_after_the_performance_has_ended():
    here, screen, drawn = shared(), Screen(), []
    here.write(ShownFace(7, 0.0, (0.0, 0.0, 0.0), {"12": 0.4}))
    here.end()
    assert run_preview(here, screen, lambda shown, told: drawn.append(shown), Controls()) == 1
    assert [shown.number for shown in drawn] == [7]


def test_pressed_keys_change_the_preview_picture():
    here, given_values = shared(), []
    here.end()
    run_preview(here, Screen(keys=["3", "up"]), lambda shown, controls: given_values.append(controls), Controls())
    assert (given_values[-1].preset, given_values[-1].units) == ("full", {12: 0.1})


@pytest.mark.parametrize("screen", [Screen(pictures=1), Screen(keys=["escape"])])
def test_closing_the_preview_window_ends_drawing(screen: Screen):
    here = shared()
    assert run_preview(here, screen, lambda shown, told: None, Controls()) <= 1


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("upper22")


@pytest.mark.soak
def test_preview_write_takes_less_than_a_fifth_of_a_drawing_and_returns_after_closing(drawable: None, robot: Robot):
    """Expect dropped pictures instead of delayed commands.

    After the end, as after a closed window, commands are accepted but not drawn.
    """
    with Portrait(preset=DRAFT_PRESET, size=(256, 256)) as portrait:
        began = time.perf_counter()
        for k in range(5):
            portrait.draw({"12": k / 5})
        picture = (time.perf_counter() - began) / 5
    with Preview(robot, look=SMALL_SETTINGS, windowed=False) as preview:
        began = time.perf_counter()
        for k in range(1000):
            preview.write(command(k / 100, {"26": k / 1000}, robot.skeleton.rest))
        spent = (time.perf_counter() - began) / 1000
        assert not preview.closed
    assert spent < picture / 5
    shown = preview._shared.read()
    assert (shown.number, shown.time, shown.units) == (1000, 9.99, {"26": 0.999})
    assert preview.closed
    play((command(k / 100, {"12": 0.5}, robot.skeleton.rest) for k in range(100)), preview)


def test_preview_window_shows_the_body_film_at_the_time_of_the_face(drawable: None, tmp_path: Path):
    path = tmp_path / "film.webp"
    save_film([np.full((30, 40, 3), 25 * k, dtype=np.uint8) for k in range(10)], path, rate=10.0)
    body = SideFilm(path, 60)
    assert body.at(0.0).shape == (60, 80, 3)
    for time_s, shade in ((0.05, 0), (0.35, 75), (0.35, 75), (5.0, 225)):
        assert body.at(time_s).mean() == pytest.approx(shade, abs=4)
    with open_offscreen_context() as context:
        draw = make_painter(context, (60, 60), SideFilm(path, 60))
        pixels = draw(ShownFace(1, 0.55, (0.0, 0.0, 0.0), {}), Controls(preset="draft"))
    assert pixels.shape == (60, 140, 3)
    assert pixels[:, 60:].mean() == pytest.approx(125, abs=4)


def test_invalid_body_film_in_the_preview_gives_a_one_line_error(tmp_path: Path):
    (tmp_path / "film.webp").write_text("nothing")
    with pytest.raises(DisplayError, match=r"film\.webp: not a film: ") as caught:
        SideFilm(tmp_path / "film.webp", 60)
    assert "\n" not in str(caught.value)


def test_face_preview_without_a_display_gives_a_one_line_error(drawable: None, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    pytest.importorskip("glfw")
    if has_display():
        pytest.skip("this system has a display in any case")
    with pytest.raises(DisplayError, match="no window: ") as caught:
        Preview(look=SMALL_SETTINGS, windowed=True)
    assert "\n" not in str(caught.value)
    assert "--out" in str(caught.value)


@pytest.fixture
def display() -> Iterator[str]:
    """Invisible display."""
    server = shutil.which("Xvfb")
    if server is None:
        pytest.skip("no Xvfb: apt-get install xvfb")
    reader, writer = os.pipe()
    words = [server, "-displayfd", str(writer), "-screen", "0", "320x240x24", "-nolisten", "tcp"]
    with subprocess.Popen(words, pass_fds=[writer], stderr=subprocess.DEVNULL) as running:
        os.close(writer)
        with os.fdopen(reader) as result:
            number = result.readline().strip()
        yield f":{number}"
        running.terminate()


WINDOW_PROGRAM = """
import ctypes
import glfw
from kinesic.face.gl import numbers as gl
from kinesic.face.show.shared_command import ShownFace
from kinesic.face.show.controls import Controls
from kinesic.face.show.process import make_painter, run_preview
from kinesic.face.show.window import open_window

class SharedCommand:
    is_over = False
    def read(self):
        return ShownFace(1, 0.0, (0.0, 0.0, 0.0), {"12": 0.7})

with open_window((64, 64), "t") as framed:
    picture = make_painter(framed.context, (64, 64))
    def draw(shown, controls):
        glfw.set_window_should_close(framed._handle, True)
        return picture(shown, controls)
    pictures = run_preview(SharedCommand(), framed, draw, Controls(preset="draft"))
    framed.context.bind(0)
    seen = ctypes.create_string_buffer(64 * 64 * 3)
    framed.context.functions.PixelStorei(gl.GL_PACK_ALIGNMENT, 1)
    framed.context.functions.ReadPixels(0, 0, 64, 64, gl.GL_RGB, gl.GL_UNSIGNED_BYTE, seen)
print(pictures, len(set(seen.raw)) > 50)
"""


@pytest.mark.soak
def test_face_window_shows_the_picture_until_closed(drawable: None, display: str):
    pytest.importorskip("glfw")
    environment = {**os.environ, "DISPLAY": display}
    ended = subprocess.run(
        [sys.executable, "-c", WINDOW_PROGRAM], env=environment, capture_output=True, text=True, check=False
    )
    assert ended.stdout.split() == ["1", "True"], ended.stderr


def test_face_preview_opens_a_window_if_there_is_a_display(
    drawable: None, display: str, monkeypatch: pytest.MonkeyPatch
):
    pytest.importorskip("glfw")
    monkeypatch.setenv("DISPLAY", display)
    with Preview(look=SMALL_SETTINGS) as preview:
        preview.write(command(0.0, {"12": 0.5}))
        assert not preview.closed
    assert preview._child.wait() == 0

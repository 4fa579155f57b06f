import os
import subprocess
import sys

import pytest

from kinesic.face import display
from kinesic.face.display import INSTALL_DRIVER, INSTALL_LIBRARY, DisplayError, available, offscreen


def draws() -> None:
    """Skips where nothing can be drawn, saying why."""
    reason = available()
    if reason is not None:
        pytest.skip(reason)


def test_a_picture_is_drawn_and_read_back():
    draws()
    with offscreen() as context:
        frame = context.simple_framebuffer((4, 4))
        frame.use()
        frame.clear(1.0, 0.0, 0.0)
        pixels = frame.read()
        error = context.error
    assert pixels == b"\xff\x00\x00" * 16
    assert error == "GL_NO_ERROR"


def test_a_mistake_inside_is_not_called_a_missing_display():
    draws()
    with pytest.raises(KeyError, match="mine"), offscreen():
        raise KeyError("mine")


def test_a_missing_library_names_the_command(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "moderngl", None)
    with pytest.raises(DisplayError, match="moderngl is not installed") as caught, offscreen():
        pass
    assert INSTALL_LIBRARY in str(caught.value)
    assert available() == str(caught.value)


@pytest.mark.parametrize(
    ("variable", "value", "says"),
    [
        ("MESA_GL_VERSION_OVERRIDE", "2.1", "OpenGL is 2.1 here, a face needs 3.3"),
        ("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere", "EGL finds no device to draw with"),
        ("LIBGL_DRIVERS_PATH", "/nowhere", "EGL does not start"),
    ],
)
def test_a_driver_that_cannot_is_one_line(variable: str, value: str, says: str):
    draws()
    words = [sys.executable, "-c", "from kinesic.face.display import available; print(available())"]
    told = subprocess.run(words, env={**os.environ, variable: value}, capture_output=True, text=True, check=True).stdout
    if told.strip() == "None":
        pytest.skip(f"this driver does not listen to {variable}")
    assert says in told
    assert told.strip().endswith(INSTALL_DRIVER)
    assert told.count("\n") == 1


def test_missing_libraries_are_named(monkeypatch: pytest.MonkeyPatch):
    pytest.importorskip("moderngl")
    monkeypatch.setattr(display, "EGL", "libabsent.so.1")
    display.driver.cache_clear()
    try:
        reason = available()
    finally:
        display.driver.cache_clear()
    assert reason is not None
    assert reason.startswith("no OpenGL: libabsent.so.1 ")  # and others, where there are none
    assert "cannot be loaded" in reason
    assert reason.endswith(INSTALL_DRIVER)

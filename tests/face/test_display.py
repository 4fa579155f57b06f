import ctypes
import os
import subprocess
import sys

import pytest

from kinesic.face.display import INSTALL_DRIVER, available, offscreen
from kinesic.face.gl import egl


def draws() -> None:
    """Skips where nothing can be drawn, saying why."""
    reason = available()
    if reason is not None:
        pytest.skip(reason)


def test_a_picture_is_drawn_and_read_back():
    draws()
    with offscreen() as context:
        frame = context.frame([context.texture((4, 4), 3)])
        frame.clear(1.0, 0.0, 0.0)
        pixels = frame.read()
        error = context.error
    assert pixels == b"\xff\x00\x00" * 16
    assert error == 0


def test_a_mistake_inside_is_not_called_a_missing_display():
    draws()
    with pytest.raises(KeyError, match="mine"), offscreen():
        raise KeyError("mine")


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
    monkeypatch.setattr(egl, "EGL", "libabsent.so.1")
    monkeypatch.setattr(egl, "started", egl.Egl)
    reason = available()
    assert reason is not None
    assert reason.startswith("no OpenGL: libabsent.so.1 ")  # and others, where there are none
    assert "cannot be loaded" in reason
    assert reason.endswith(INSTALL_DRIVER)


def test_a_device_that_does_not_start_leaves_the_next(monkeypatch: pytest.MonkeyPatch):
    """As where a machine has a card that is not ours to use, before one that is."""
    draws()
    real = egl._DEVICES

    def with_one_before(address: int):
        def query(most: int, devices, count) -> int:
            found = real(address)(most - 1, ctypes.byref(devices, ctypes.sizeof(ctypes.c_void_p)), count)
            devices[0], count._obj.value = 1, count._obj.value + 1
            return int(found)

        return query

    monkeypatch.setattr(egl, "_DEVICES", with_one_before)
    monkeypatch.setattr(egl, "started", egl.Egl)
    assert available() is None


def test_a_driver_that_knows_all_functions_needs_no_other_library(monkeypatch: pytest.MonkeyPatch):
    draws()
    monkeypatch.setattr(egl, "GL", ("libabsent.so.1",))
    monkeypatch.setattr(egl, "started", egl.Egl)
    assert available() is None


DRAWS = """
import sys
from kinesic.face.render.portrait import Portrait
with Portrait(size=(32, 32)) as portrait:
    portrait.draw({})
files = [str(getattr(module, "__file__", "")).partition("site-packages/")[2] for module in sys.modules.values()]
print(*{each.partition("/")[0] for each in files if each.endswith(".so")})
"""


def test_nothing_compiled_is_drawn_with_but_the_driver():
    """So that it draws wherever kinesic's core installs, without a compiler."""
    draws()
    told = subprocess.run([sys.executable, "-c", DRAWS], capture_output=True, text=True, check=True).stdout
    assert set(told.split()) <= {"numpy", "scipy", "msgspec", "PIL"}

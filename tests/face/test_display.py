import sys
from types import ModuleType

import pytest

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


def test_a_missing_driver_names_the_command(monkeypatch: pytest.MonkeyPatch):
    class Driverless(ModuleType):
        def create_context(self, **_: object) -> None:
            raise Exception("libGL.so not loaded")

    monkeypatch.setitem(sys.modules, "moderngl", Driverless("moderngl"))
    with pytest.raises(DisplayError, match=r"libGL\.so not loaded") as caught, offscreen():
        pass
    assert INSTALL_DRIVER in str(caught.value)
    assert "\n" not in str(caught.value)

import ctypes
import os
import subprocess
import sys

import pytest

from kinesic import egl
from kinesic.extras import install_extra
from kinesic.face.display import INSTALL_DRIVER, find_display_problem, open_offscreen_context


def draws() -> None:
    """Skip the test with a reason if no picture can be drawn."""
    reason = find_display_problem()
    if reason is not None:
        pytest.skip(reason)


def test_offscreen_picture_is_drawn_and_read_back():
    draws()
    with open_offscreen_context() as context:
        frame = context.frame([context.texture((4, 4), 3)])
        frame.clear(1.0, 0.0, 0.0)
        pixels = frame.read()
        error = context.error
    assert pixels == b"\xff\x00\x00" * 16
    assert error == 0


def test_program_errors_raised_while_drawing_are_not_reported_as_display_errors():
    draws()
    with pytest.raises(KeyError, match="mine"), open_offscreen_context():
        raise KeyError("mine")


@pytest.mark.parametrize(
    ("variable", "value", "says"),
    [
        ("MESA_GL_VERSION_OVERRIDE", "2.1", "OpenGL is 2.1 here, the face needs 3.3"),
        ("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere", "EGL finds no device to draw with"),
        ("LIBGL_DRIVERS_PATH", "/nowhere", "EGL does not start"),
    ],
)
def test_unsuitable_opengl_driver_gives_a_one_line_error(variable: str, value: str, says: str):
    draws()
    words = [
        sys.executable,
        "-c",
        "from kinesic.face.display import find_display_problem; print(find_display_problem())",
    ]
    output = subprocess.run(
        words, env={**os.environ, variable: value}, capture_output=True, text=True, check=True
    ).stdout
    if output.strip() == "None":
        pytest.skip(f"this driver does not listen to {variable}")
    assert says in output
    assert output.strip().endswith(INSTALL_DRIVER)
    assert output.count("\n") == 1


def test_missing_opengl_libraries_are_named_in_the_error(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(egl, "EGL_LIBRARY", "libabsent.so.1")
    monkeypatch.setattr(egl, "start_egl", egl.Egl)
    reason = find_display_problem()
    assert reason is not None
    assert reason.startswith("no OpenGL: libabsent.so.1 ")  # further libraries may be missing, too
    assert "cannot be loaded" in reason
    assert reason.endswith(INSTALL_DRIVER)


def test_second_graphics_device_draws_if_the_first_one_fails(monkeypatch: pytest.MonkeyPatch):
    """Skip an inaccessible graphics card before an accessible one."""
    draws()
    real = egl._QueryDevices

    def with_one_before(address: int):
        def query(most: int, devices, count) -> int:
            actual = real(address)(most - 1, ctypes.byref(devices, ctypes.sizeof(ctypes.c_void_p)), count)
            devices[0], count._obj.value = 1, count._obj.value + 1
            return int(actual)

        return query

    monkeypatch.setattr(egl, "_QueryDevices", with_one_before)
    monkeypatch.setattr(egl, "start_egl", egl.Egl)
    assert find_display_problem() is None


def test_egl_driver_with_all_functions_needs_no_libgl(monkeypatch: pytest.MonkeyPatch):
    draws()
    monkeypatch.setattr(egl, "GL_LIBRARIES", ("libabsent.so.1",))
    monkeypatch.setattr(egl, "start_egl", egl.Egl)
    assert find_display_problem() is None


DRAWING_PROGRAM = """
import sys
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT_PRESET
with Portrait(size=(32, 32), preset=DRAFT_PRESET) as portrait:
    portrait.draw({})
files = [str(getattr(module, "__file__", "")).partition("site-packages/")[2] for module in sys.modules.values()]
print(*{each.partition("/")[0] for each in files if each.endswith(".so")})
"""


def test_face_rendering_imports_no_compiled_packages_except_the_core_dependencies():
    """Allow rendering on every machine that runs kinesic's core."""
    draws()
    output = subprocess.run([sys.executable, "-c", DRAWING_PROGRAM], capture_output=True, text=True, check=True).stdout
    assert set(output.split()) <= {"numpy", "scipy", "msgspec", "PIL"}


@pytest.mark.parametrize(("module", "name"), [("scipy", "scipy"), ("PIL", "Pillow")])
def test_missing_package_is_the_reported_reason_why_no_face_can_be_drawn(module, name, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    assert find_display_problem() == f"{name} is not installed: {install_extra('face')}"

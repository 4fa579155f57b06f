import os
import subprocess
import sys

import pytest

from kinesic.sim import gl


@pytest.fixture
def no_libraries(monkeypatch):
    monkeypatch.setattr(gl, "_loads", lambda library: False)
    gl.opengl_fault.cache_clear()
    yield
    gl.opengl_fault.cache_clear()


@pytest.fixture
def all_libraries(monkeypatch):
    monkeypatch.setattr(gl, "_loads", lambda library: True)


@pytest.mark.parametrize("asked", ["disable", "off", "glfw", "glx"])
def test_a_harmless_wish_of_the_user_stays(asked, all_libraries):
    environment = {"MUJOCO_GL": asked}
    assert gl.prepare(environment) == asked
    assert environment == {"MUJOCO_GL": asked}


@pytest.mark.parametrize("asked", ["", "egl", "EGL", "nonsense"])
def test_egl_is_chosen_where_its_libraries_are(asked, all_libraries):
    environment = {"MUJOCO_GL": asked}
    assert gl.prepare(environment) == environment["MUJOCO_GL"] == "egl"


@pytest.mark.parametrize("asked", ["", "egl", "osmesa", "nonsense"])
def test_without_libraries_drawing_is_off(asked, no_libraries):
    environment = {"MUJOCO_GL": asked}
    assert gl.prepare(environment) == environment["MUJOCO_GL"] == "disable"


def test_another_platform_of_pyopengl_rules_out_egl(all_libraries):
    assert gl.prepare({"PYOPENGL_PLATFORM": "osmesa"}) == "disable"


def test_the_fault_names_the_libraries_and_the_line_that_mends(no_libraries):
    why = gl.opengl_fault()
    assert why is not None
    assert "libEGL.so.1" in why
    assert gl.APT_LINE in why


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux reads MUJOCO_GL this way")
@pytest.mark.parametrize("asked", ["egl", "nonsense"])
def test_mujoco_imports_after_this_room_whatever_was_asked(asked):
    program = "import kinesic.sim, mujoco; print(mujoco.mj_version() > 0)"
    environment = {**os.environ, "MUJOCO_GL": asked}
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment, check=False)
    assert done.stdout.strip() == "True", done.stderr

import os
import subprocess
import sys

import pytest

from kinesic.files.late_pillow import explain_missing_pillow
from kinesic.sim import gl


@pytest.fixture
def no_libraries(monkeypatch):
    monkeypatch.setattr(gl, "_can_load", lambda library: False)
    gl.opengl_fault.cache_clear()
    yield
    gl.opengl_fault.cache_clear()


@pytest.fixture
def all_libraries(monkeypatch):
    monkeypatch.setattr(gl, "_can_load", lambda library: True)


@pytest.mark.parametrize("asked", ["disable", "off", "glfw", "glx"])
def test_mujoco_gl_set_to_disable_off_glfw_or_glx_is_kept(asked, all_libraries):
    environment = {"MUJOCO_GL": asked}
    assert gl.prepare(environment) == asked
    assert environment == {"MUJOCO_GL": asked}


@pytest.mark.parametrize("asked", ["", "egl", "EGL", "nonsense"])
def test_egl_is_selected_if_its_libraries_exist(asked, all_libraries):
    environment = {"MUJOCO_GL": asked}
    assert gl.prepare(environment) == environment["MUJOCO_GL"] == "egl"


@pytest.mark.parametrize("asked", ["", "egl", "osmesa", "nonsense"])
def test_mujoco_rendering_is_disabled_without_opengl_libraries(asked, no_libraries):
    environment = {"MUJOCO_GL": asked}
    assert gl.prepare(environment) == environment["MUJOCO_GL"] == "disable"


def test_pyopengl_platform_other_than_egl_selects_glfw_and_keeps_drawing_enabled(all_libraries):
    environment = {"PYOPENGL_PLATFORM": "osmesa"}
    assert gl.prepare(environment) == "glfw"
    assert not gl.is_switched_off(environment)


def test_opengl_fault_names_the_missing_library_and_the_install_command(no_libraries):
    why = gl.opengl_fault()
    assert why is not None
    assert "libEGL.so.1" in why
    assert gl.INSTALL_COMMAND in why


def test_missing_pillow_is_reported_as_a_missing_library(all_libraries, monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    reason = explain_missing_pillow()
    assert reason is not None
    assert gl.missing_libraries() == reason


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux reads MUJOCO_GL this way")
@pytest.mark.parametrize("asked", ["egl", "nonsense"])
def test_mujoco_imports_after_kinesic_sim_for_any_mujoco_gl(asked):
    program = "import kinesic.sim, mujoco; print(mujoco.mj_version() > 0)"
    environment = {**os.environ, "MUJOCO_GL": asked}
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment, check=False)
    assert done.stdout.strip() == "True", done.stderr

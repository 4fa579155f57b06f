import os
import subprocess
import sys

import mujoco
import pytest

from kinesic.sim.filming.offscreen import Offscreen, OffscreenError
from kinesic.sim.filming.scene_renderer import SceneRenderer
from kinesic.sim.gl import opengl_fault

SPHERE = '<mujoco><worldbody><light pos="0 0 3"/><geom size="1" rgba="1 0 0 1"/></worldbody></mujoco>'
WITHOUT_PYOPENGL = f"""
import sys
sys.modules["OpenGL"] = sys.modules["glfw"] = None
import kinesic.sim, mujoco, numpy as np
from kinesic.sim.filming.offscreen import Offscreen
model = mujoco.MjModel.from_xml_string('{SPHERE}')
with Offscreen(model, (8, 8)) as offscreen:
    offscreen.read(picture := np.empty((8, 8, 4), dtype=np.uint8))
print(picture.shape)
"""


@pytest.fixture(scope="module")
def opengl() -> None:
    if reason := opengl_fault():
        pytest.skip(reason)


def test_scene_is_drawn_upright_by_a_camera(opengl):
    model = mujoco.MjModel.from_xml_string(SPHERE)
    camera, data = mujoco.MjvCamera(), mujoco.MjData(model)
    camera.lookat[:], camera.distance, camera.elevation = (0.0, 0.0, 1.0), 8.0, 0.0
    mujoco.mj_forward(model, data)
    with SceneRenderer(model, (32, 32)) as renderer:
        picture = renderer.draw(data, camera)
    red = picture[..., 0].astype(int) - picture[..., 1]
    assert picture.shape == (32, 32, 3)
    assert red[20, 16] > 30, "the sphere is below the middle"
    assert not red[:8].any()


@pytest.mark.skipif(sys.platform != "linux", reason="MuJoCo opens the context with PyOpenGL")
def test_mujoco_draws_without_pyopengl(opengl):
    ended = subprocess.run([sys.executable, "-c", WITHOUT_PYOPENGL], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (0, "(8, 8, 4)\n"), ended.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux reads MUJOCO_GL this way")
def test_offscreen_drawing_switched_off_by_mujoco_gl_is_refused(monkeypatch):
    monkeypatch.setitem(os.environ, "MUJOCO_GL", "off")
    with pytest.raises(OffscreenError, match="switched off by MUJOCO_GL"):
        Offscreen(mujoco.MjModel.from_xml_string(SPHERE), (8, 8))

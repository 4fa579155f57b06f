"""A machine without OpenGL."""

import subprocess
import sys

HIDDEN = "import sys; sys.modules['OpenGL.raw.GL.VERSION.GL_1_0'] = None; import kinesic.sim.film"


def test_a_report_without_films_looks_for_no_opengl():
    ended = subprocess.run([sys.executable, "-c", HIDDEN], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr

"""Reports on a machine without OpenGL."""

import os
import subprocess
import sys

OPENGL_CHECK = "import sys, kinesic.sim.film; print(any(name.startswith('OpenGL') for name in sys.modules))"


def test_import_of_the_film_module_does_not_load_opengl():
    nowhere = {**os.environ, "MUJOCO_GL": "disabled"}
    ended = subprocess.run(
        [sys.executable, "-c", OPENGL_CHECK], capture_output=True, text=True, check=False, env=nowhere
    )
    assert (ended.returncode, ended.stdout) == (0, "False\n"), ended.stderr

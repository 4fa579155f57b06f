"""A machine without OpenGL."""

import os
import subprocess
import sys

LOADED = "import sys, kinesic.sim.film; print(any(name.startswith('OpenGL') for name in sys.modules))"


def test_a_report_without_films_looks_for_no_opengl():
    nowhere = {**os.environ, "MUJOCO_GL": "disabled"}
    ended = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=False, env=nowhere)
    assert (ended.returncode, ended.stdout) == (0, "False\n"), ended.stderr

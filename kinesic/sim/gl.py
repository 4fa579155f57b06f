"""Decides how MuJoCo may draw, before MuJoCo is imported: a wrong MUJOCO_GL breaks `import mujoco` itself.

Importing `kinesic.sim` calls `prepare`, which only asks the loader for libraries; `opengl_fault` draws once in another
process and is asked only by those who want pictures.
"""

import ctypes
import os
import platform
import subprocess
import sys
from collections.abc import MutableMapping
from functools import cache

APT_LINE = "apt-get install libegl1 libgl1-mesa-dri libopengl0"
_OFF = ("disable", "disabled", "off", "false", "0")
_HARMLESS = (*_OFF, "enable", "enabled", "on", "true", "1", "glfw", "glx")  # these never break the import
_PROBE = """
import mujoco
model = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
renderer = mujoco.Renderer(model, 8, 8)
renderer.update_scene(mujoco.MjData(model))
renderer.render()
renderer.close()
"""


def prepare(environment: MutableMapping[str, str] = os.environ) -> str:
    """Sets MUJOCO_GL so that `import mujoco` works: `egl` where its libraries are, else `disable`.

    A value set by the user stays unless its libraries are missing. Only Linux needs this.

    Args:
        environment: where the variable is read and set.

    Returns:
        The value now in force.
    """
    asked = environment.get("MUJOCO_GL", "").lower().strip()
    if platform.system() != "Linux" or asked in _HARMLESS or (asked == "osmesa" and _loads("libOSMesa.so.8")):
        return asked
    environment["MUJOCO_GL"] = "disable" if _absent(environment) else "egl"
    return environment["MUJOCO_GL"]


def missing_libraries() -> str | None:
    """Finds what hinders drawing as far as it shows without trying, with the line that mends it."""
    if platform.system() == "Linux":
        if absent := _absent(os.environ):
            return f"OpenGL is missing ({', '.join(absent)}): {APT_LINE}"
        if os.environ.get("MUJOCO_GL", "").lower().strip() in _OFF:
            return f"drawing is switched off by MUJOCO_GL={os.environ['MUJOCO_GL']}: unset it"
    return None


@cache
def opengl_fault() -> str | None:
    """Finds what hinders drawing, with the line that mends it; None when a picture was really drawn.

    Draws once in another process, since a missing driver may end the process that tries.
    """
    if why := missing_libraries():
        return why
    try:
        probe = subprocess.run(
            [sys.executable, "-c", _PROBE], capture_output=True, text=True, timeout=60, check=False, env=os.environ
        )
    except subprocess.TimeoutExpired:
        return f"OpenGL did not draw within 60 s: {APT_LINE}"
    if probe.returncode == 0:
        return None
    last = (probe.stderr.strip().splitlines() or [f"exit code {probe.returncode}"])[-1]
    return f"OpenGL does not draw ({last}): {APT_LINE}"


def _absent(environment: MutableMapping[str, str]) -> list[str]:
    absent = [] if _loads("libEGL.so.1") else ["libEGL.so.1"]
    if not (_loads("libOpenGL.so.0") or _loads("libGL.so.1")):
        absent.append("libOpenGL.so.0")
    platform_requested = environment.get("PYOPENGL_PLATFORM", "egl").lower()
    return absent if platform_requested == "egl" else [*absent, f"EGL, since PYOPENGL_PLATFORM is {platform_requested}"]


@cache
def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True

"""Selection of MuJoCo's OpenGL backend before MuJoCo is imported.

A wrong MUJOCO_GL breaks `import mujoco` itself. Importing `kinesic.sim` calls `prepare`, which only loads libraries.
`opengl_fault` draws once in another process; only callers that need pictures call it.
"""

import ctypes
import os
import platform
import subprocess
import sys
from collections.abc import Mapping, MutableMapping
from functools import cache

from kinesic.files.late_pillow import explain_missing_pillow

INSTALL_COMMAND = "apt-get install libegl1 libgl1-mesa-dri libopengl0"
_OFF_VALUES = ("disable", "disabled", "off", "false", "0")  # values of MUJOCO_GL that disable drawing
_SAFE_VALUES = (*_OFF_VALUES, "enable", "enabled", "on", "true", "1", "glfw", "glx")  # values that let MuJoCo load
_DRAWING_TEST = """
from kinesic.sim.filming.offscreen import Offscreen
import mujoco
model = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
with Offscreen(model, (8, 8)) as offscreen:
    scene = mujoco.MjvScene(model=model, maxgeom=10)
    mujoco.mjr_render(mujoco.MjrRect(0, 0, 8, 8), scene, offscreen.context)
"""


def prepare(environment: MutableMapping[str, str] = os.environ) -> str:
    """Set MUJOCO_GL so that `import mujoco` works.

    The value is `egl` if its libraries are installed (`glfw` if PYOPENGL_PLATFORM asks for another platform), otherwise
    `disable`. A value set by the user stays unless its
    libraries are missing. Only Linux needs this, and only for programs that draw by MuJoCo's own renderer.

    Args:
        environment: Mapping from which the variable is read and in which it is set.

    Returns:
        The value now in force.
    """
    requested = environment.get("MUJOCO_GL", "").lower().strip()
    if (
        platform.system() != "Linux"
        or requested in _SAFE_VALUES
        or (requested == "osmesa" and _can_load("libOSMesa.so.8"))
    ):
        return requested
    if _find_missing_libraries():
        environment["MUJOCO_GL"] = "disable"
    else:  # MuJoCo's own use of EGL refuses another platform of PyOpenGL; kinesic draws without PyOpenGL
        environment["MUJOCO_GL"] = "egl" if environment.get("PYOPENGL_PLATFORM", "egl").lower() == "egl" else "glfw"
    return environment["MUJOCO_GL"]


def missing_libraries() -> str | None:
    """Return a missing library or setting that prevents drawing, or None.

    Returns:
        The reason with a remedy: Pillow, OpenGL or MUJOCO_GL; None if no obstacle was found.
    """
    if problem := explain_missing_pillow():
        return problem
    if platform.system() == "Linux":
        if missing := _find_missing_libraries():
            return f"OpenGL is missing ({', '.join(missing)}): {INSTALL_COMMAND}"
        if is_switched_off(os.environ):
            return f"drawing is switched off by MUJOCO_GL={os.environ['MUJOCO_GL']}: unset it"
    return None


def is_switched_off(environment: Mapping[str, str]) -> bool:
    """Return whether the user has switched drawing off by MUJOCO_GL."""
    return environment.get("MUJOCO_GL", "").lower().strip() in _OFF_VALUES


@cache
def opengl_fault() -> str | None:
    """Test OpenGL drawing in another process and return the fault, or None.

    A missing driver may end the process that tries.

    Returns:
        The reason that prevents drawing, with a remedy; None if a picture was drawn.
    """
    if reason := missing_libraries():
        return reason
    try:
        probe = subprocess.run(
            [sys.executable, "-c", _DRAWING_TEST],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
            env=os.environ,
        )
    except subprocess.TimeoutExpired:
        return f"OpenGL did not draw within 60 s: {INSTALL_COMMAND}"
    if probe.returncode == 0:
        return None
    last = (probe.stderr.strip().splitlines() or [f"exit code {probe.returncode}"])[-1]
    return f"OpenGL does not draw ({last}): {INSTALL_COMMAND}"


def _find_missing_libraries() -> list[str]:
    missing = [] if _can_load("libEGL.so.1") else ["libEGL.so.1"]
    if not (_can_load("libOpenGL.so.0") or _can_load("libGL.so.1")):
        missing.append("libOpenGL.so.0")
    return missing


@cache
def _can_load(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True

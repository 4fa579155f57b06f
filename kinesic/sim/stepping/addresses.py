"""Addresses of MuJoCo functions and options for a compiled loop."""

import ctypes
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import mujoco

from kinesic.body.arrays import Floats, Indices

MARKER_TIMESTEP = 0.0012345678912345  # [s] distinctive timestep, searched in memory to find its address
MAX_OPTION_WORDS = 32  # largest number of doubles between the addresses of MuJoCo's timestep and gravity
DOUBLE_SIZE = ctypes.sizeof(ctypes.c_double)  # [bytes] size of a C double


@dataclass(frozen=True, eq=False)
class TwinParts:
    """Addresses and arrays of a twin's physics for a compiled loop.

    MuJoCo owns the arrays.
    """

    step: int  # address of the function `mj_step`
    model: int  # address of mjModel
    data: int  # address of mjData
    clock: int  # address of MuJoCo's timer callback `mjcb_time`; 0: none
    timestep: int  # address of the timestep in the model
    positions: Floats  # (q,) [rad] qpos
    velocities: Floats  # (q,) [rad/s] qvel
    control: Floats  # (u,) [rad] ctrl
    hinges: Indices  # (n,) indices in qpos
    play: Indices  # (n,) indices of backlash joints in qpos; (0,) without backlash
    actuators: Indices  # (n,) indices in ctrl
    ticks: Floats  # (n,) [rad] rounding unit of setpoints and positions; (0,): no rounding
    longest: float  # [s] longest step
    latency: float  # [s] from a command until its setpoints act


@cache
def function_address(name: str) -> int | None:
    """Return a symbol's address in the loaded MuJoCo library, or None.

    The name belongs to a function or a variable.

    Returns:
        None if the library has no such name.
    """
    for library in sorted(Path(mujoco.__file__).parent.glob("libmujoco*")):
        try:
            value = getattr(ctypes.CDLL(str(library)), name)
        except (OSError, AttributeError):
            continue
        return ctypes.cast(value, ctypes.c_void_p).value
    return None


def timestep_address(model: mujoco.MjModel) -> int | None:
    """Return the address of a model's timestep, or None.

    Returns:
        None if the timestep is not stored shortly before gravity.
    """
    offset = _find_timestep_offset()
    if offset is None:
        return None
    address = int(model._address) + offset
    value = ctypes.c_double.from_address(address).value
    return address if value == model.opt.timestep else None


@cache
def _find_timestep_offset() -> int | None:
    """Return the timestep's offset [bytes] in a model, or None.

    The timestep is found by a marker value that is unique among the options.
    """
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    gravity = model.opt.gravity.__array_interface__["data"][0]
    if gravity - MAX_OPTION_WORDS * DOUBLE_SIZE < model._address:
        return None
    model.opt.timestep = MARKER_TIMESTEP
    words = (ctypes.c_double * MAX_OPTION_WORDS).from_address(gravity - MAX_OPTION_WORDS * DOUBLE_SIZE)
    marker_indices = [k for k, word in enumerate(words) if word == MARKER_TIMESTEP]
    return (
        gravity - MAX_OPTION_WORDS * DOUBLE_SIZE + marker_indices[0] * DOUBLE_SIZE - int(model._address)
        if len(marker_indices) == 1
        else None
    )

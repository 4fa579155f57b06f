"""Finds where MuJoCo keeps what a compiled loop needs, so that it steps the physics without Python between."""

import ctypes
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import mujoco

from kinesic.body.arrays import Floats, Indices

MARK = 0.0012345678912345  # [s] a timestep that nothing else is
OPTIONS = 32  # numbers at most from the timestep, which is the first of MuJoCo's options, to gravity
WORD = ctypes.sizeof(ctypes.c_double)


@dataclass(frozen=True, eq=False)
class TwinParts:
    """A twin's physics for a compiled loop; the arrays are MuJoCo's own."""

    step: int  # address of the function `mj_step`
    model: int  # address
    data: int  # address
    clock: int  # address of the pointer to the function by which MuJoCo times its stages; 0: there is none
    timestep: int  # address, within the model
    positions: Floats  # (q,) [rad] qpos
    speeds: Floats  # (q,) [rad/s] qvel
    control: Floats  # (u,) [rad] ctrl
    hinges: Indices  # (n,) places in qpos
    play: Indices  # (n,) places of the play of gears in qpos; (0,) where they have none
    actuators: Indices  # (n,) places in ctrl
    ticks: Floats  # (n,) [rad] to which goals and positions are rounded; (0,): they are not
    longest: float  # [s] of a step
    latency: float  # [s] of goals


@cache
def function_address(name: str) -> int | None:
    """Finds the address of a function or a variable of the library that Python's MuJoCo has loaded; None: no such."""
    for library in sorted(Path(mujoco.__file__).parent.glob("libmujoco*")):
        try:
            found = getattr(ctypes.CDLL(str(library)), name)
        except (OSError, AttributeError):
            continue
        return ctypes.cast(found, ctypes.c_void_p).value
    return None


def timestep_address(model: mujoco.MjModel) -> int | None:
    """Finds the address of a model's timestep; None where it does not stand a little before gravity."""
    offset = _timestep_offset()
    if offset is None:
        return None
    address = int(model._address) + offset
    found = ctypes.c_double.from_address(address).value
    return address if found == model.opt.timestep else None


@cache
def _timestep_offset() -> int | None:
    """Bytes from the start of any model to its timestep, by looking for a mark among its options."""
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    gravity = model.opt.gravity.__array_interface__["data"][0]
    if gravity - OPTIONS * WORD < model._address:
        return None
    model.opt.timestep = MARK
    words = (ctypes.c_double * OPTIONS).from_address(gravity - OPTIONS * WORD)
    marked = [k for k, word in enumerate(words) if word == MARK]
    return gravity - OPTIONS * WORD + marked[0] * WORD - int(model._address) if len(marked) == 1 else None

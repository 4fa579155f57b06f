"""MPEG-4 body animation parameters as text (the BAP file format, ISO/IEC 14496-2 annex C)."""

from pathlib import Path

import numpy as np

from kinesic.body.robot import Robot
from kinesic.controller.trajectory import Trajectory

RATE = 25  # [frames/s]
PARAMETERS = 296
PER_RADIAN = 1e5  # the unit of angles is 1e-5 rad

_PAIRS = (
    ("sternoclavicular_abduct", 24),
    ("sternoclavicular_rotate", 26),
    ("acromioclavicular_abduct", 28),
    ("acromioclavicular_rotate", 30),
    ("shoulder_flexion", 32),
    ("shoulder_abduct", 34),
    ("shoulder_twisting", 36),
    ("elbow_flexion", 38),
    ("elbow_twisting", 40),
    ("wrist_flexion", 42),
    ("wrist_pivot", 44),
    ("wrist_twisting", 46),
)
_SPINE = (
    "skullbase",
    *(f"vc{k}" for k in range(1, 8)),
    *(f"vt{k}" for k in range(1, 13)),
    *(f"vl{k}" for k in range(1, 6)),
)

# Number of each parameter, from 1: pairs left then right, then the spine from the skull down (roll, torsion, tilt).
NUMBERS = (
    {f"l_{name}": number for name, number in _PAIRS}
    | {f"r_{name}": number + 1 for name, number in _PAIRS}
    | {
        f"{bone}_{turn}": 48 + 3 * k + j
        for k, bone in enumerate(_SPINE)
        for j, turn in enumerate(("roll", "torsion", "tilt"))
    }
)


def write_bap(trajectory: Trajectory, robot: Robot, path: Path) -> None:
    """Writes a motion frame by frame; hinges without a BAP name are left out.

    Angles keep the signs of the robot's TOML.
    """
    columns = sorted((NUMBERS[name], k) for k, name in enumerate(robot.skeleton.names) if name in NUMBERS)
    numbers = {number for number, _ in columns}
    mask = " ".join("1" if number in numbers else "0" for number in range(1, PARAMETERS + 1))
    count = int(np.ceil(trajectory.duration * RATE)) + 1
    angles = trajectory.sample(np.arange(count) / RATE)[0]
    lines = [f"3.2 {path.stem} {RATE} {count}"]
    for frame, row in enumerate(np.rint(angles * PER_RADIAN).astype(int)):
        lines += [mask, f"{frame} " + " ".join(str(row[k]) for _, k in columns)]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")

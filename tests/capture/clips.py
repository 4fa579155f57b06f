"""Small motion files of all formats for tests."""

import json
from io import BytesIO, StringIO

import numpy as np

SIDES = {"Left": 1.0, "Right": -1.0}
LIMB = """JOINT {side}Shoulder
{{ OFFSET {clavicle:g} 3 1 CHANNELS 3 Zrotation Xrotation Yrotation
JOINT {side}Arm
{{ OFFSET {upper:g} 0 0 CHANNELS 3 Zrotation Xrotation Yrotation
JOINT {side}ForeArm
{{ OFFSET {fore:g} 0 0 CHANNELS 3 Zrotation Xrotation Yrotation
JOINT {side}Hand
{{ OFFSET {hand:g} 0 0 CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{{ OFFSET {finger:g} 0 0 }} }} }} }} }}"""
LENGTHS = {"clavicle": 5.0, "upper": 12.0, "fore": 29.0, "hand": 26.0, "finger": 10.0}  # [cm] bone lengths
SKELETON = """HIERARCHY
ROOT Hips
{{ OFFSET 0 0 0 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
JOINT Spine
{{ OFFSET 0 40 0 CHANNELS 3 Zrotation Xrotation Yrotation
JOINT Neck
{{ OFFSET 0 10 0 CHANNELS 3 Zrotation Xrotation Yrotation
JOINT Head
{{ OFFSET 0 10 0 CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{{ OFFSET 0 20 0 }} }} }}
{left}
{right}
}} }}
"""
JOINTS = ("Hips", "Spine", "Neck", "Head", *(f"{s}{n}" for s in SIDES for n in ("Shoulder", "Arm", "ForeArm", "Hand")))


def bvh(rotations=None, *, frames=None, period=1 / 30, rename=lambda name: name, place=(0.0, 90.0, 0.0)) -> bytes:
    """Write BVH of a person with arms to the sides (y up, z ahead, centimetres).

    Args:
        rotations: joint -> (m, 3) [deg] about z, x, y; others are zero.
        frames: number of frames, m; that of the rotations, or 40, by default.
        period: [s].
        rename: changes the names of joints.
        place: (3,) [cm] of the hips.
    """
    frames = frames or (len(next(iter(rotations.values()))) if rotations else 40)
    limbs = [
        LIMB.format(side=side, **{name: sign * length for name, length in LENGTHS.items()})
        for side, sign in SIDES.items()
    ]
    skeleton = SKELETON.format(left=limbs[0], right=limbs[1])
    for name in sorted(JOINTS, key=len, reverse=True):
        skeleton = skeleton.replace(f" {name}\n", f" {rename(name)}\n")
    columns = [np.tile(place, (frames, 1))]
    columns += [(rotations or {}).get(name, np.zeros((frames, 3))) for name in JOINTS]
    text = StringIO()
    np.savetxt(text, np.concatenate(columns, axis=1), fmt="%.9g")
    return f"{skeleton.strip()}\nMOTION\nFrames: {frames}\nFrame Time: {period:.9g}\n{text.getvalue()}".encode()


def reach(frames=60, *, height=60.0, speed=1.0) -> dict[str, np.ndarray]:
    """Return BVH rotations in which the right one of two lowered arms swings forward."""
    u = np.linspace(0.0, 1.0, frames)
    swing = height * np.sin(np.pi * np.clip(speed * u, 0.0, 1.0)) ** 2
    lowered = np.zeros((frames, 3))
    lowered[:, 0] = -80.0
    right = np.stack([80.0 + 0 * u, 0 * u, swing], axis=1)
    bend = np.stack([0 * u, 0 * u, 20.0 + 0.5 * swing], axis=1)
    return {"LeftArm": lowered, "RightArm": right, "RightForeArm": bend, "LeftForeArm": -0.0 * bend}


def joint_csv(names=("a", "b"), *, unit="_rad", frames=20, amplitude=0.3, delimiter=",") -> bytes:
    """Write a CSV table of joints that swing."""
    times = np.arange(frames) / 50.0
    lines = [delimiter.join(["time_s", *(f"{name}{unit}" for name in names)])]
    for time in times:
        angles = [amplitude * np.sin(time * (k + 1)) for k in range(len(names))]
        lines.append(delimiter.join(f"{value:.9g}" for value in (time, *angles)))
    return ("\n".join(lines) + "\n").encode()


def joint_npz(**arrays) -> bytes:
    """Return an NPZ file with the given arrays."""
    file = BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


def reachy_move(poses, *, times=None, body_yaw=0.0) -> bytes:
    """Write a recorded move of the robot Reachy Mini as JSON.

    Args:
        poses: rotations (3, 3) of the head; None: a setpoint without pose.
        times: [s].
        body_yaw: [rad] of every setpoint.
    """
    targets = []
    for rotation in poses:
        pose = np.eye(4)
        if rotation is not None:
            pose[:3, :3] = rotation
        head = None if rotation is None else pose.tolist()
        targets.append({"head": head, "antennas": [0.1, 0.2], "body_yaw": body_yaw, "check_collision": False})
    times = list(times if times is not None else np.arange(len(poses)) / 100 + 5.0)
    return json.dumps({"description": "nod", "time": times, "set_target_data": targets}).encode()

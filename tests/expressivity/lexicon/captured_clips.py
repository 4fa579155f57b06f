"""Small captured gestures for tests."""

from pathlib import Path

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.expressivity.lexicon.gesture_motion import GestureMotion, HandMotion, pack_motion

TIMES = np.arange(0.0, 2.0, 0.02)  # [s] sample times of a captured gesture
MARKERS = {"start": 0.2, "ready": 0.4, "strokeStart": 0.4, "stroke": 1.0, "strokeEnd": 1.4, "relax": 1.6, "end": 1.9}
TABLE = """category = "{category}"

[[gesture]]
id = "{id}"
says = "captured"

[gesture.motion]
file = "{file}"
hand = "{hand}"
markers = {{ {markers} }}
like = "{like}"
licence = "CC0"
source = "a lab"
"""


def motion(*, sides="r", shift=0.0, height=0.3, turn=0.8) -> GestureMotion:
    """Return a hand swing in front of the body, highest at 1 s.

    Args:
        sides: hands that move.
        shift: [arm lengths] outward shift of the path.
        height: [arm lengths] height of the swing.
        turn: [rad] upward rotation of the hand.
    """
    swing = np.sin(np.pi * TIMES / 2.0) ** 2
    wrist = np.stack([0.5 + 0.1 * swing, 0.3 + shift + 0.1 * np.sin(2.0 * np.pi * TIMES), height * swing], axis=1)
    tilt = turn * swing
    pointing = np.stack([np.cos(tilt), 0 * tilt, np.sin(tilt)], axis=1)
    palm = np.stack([np.sin(tilt), 0 * tilt, -np.cos(tilt)], axis=1)
    hand = HandMotion(
        sealed(wrist), sealed(0.2 + 0 * TIMES), sealed(pointing), sealed(palm), sealed(np.ones((len(TIMES), 5)))
    )
    still = sealed(np.zeros((len(TIMES), 3)))
    return GestureMotion(sealed(TIMES), dict.fromkeys(sides, hand), still, still)


def write_gesture(
    folder: Path, id="swing", *, category="beat", hand="right", markers=MARKERS, like="beat", file="", data=None
) -> Path:
    """Write a captured gesture, and return its folder."""
    sides = {"left": "l", "right": "r", "both": "lr"}[hand]
    listed = ", ".join(f"{name} = {time}" for name, time in markers.items())
    text = TABLE.format(id=id, category=category, file=file or f"{id}.npz", hand=hand, markers=listed, like=like)
    (folder / f"{id}.toml").write_text(text)
    (folder / f"{id}.npz").write_bytes(pack_motion(motion(sides=sides)) if data is None else data)
    return folder

"""Draw docs/pictures/human-skin.png: 21 extreme postures, blended linearly and, below each, by dual quaternions."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.arrays import Picture
from kinesic.body.robot import Robot
from kinesic.face.assets.skinning import Blending
from kinesic.face.render.figure import UPPER_BODY_CAMERA, FigurePortrait

SIDE, ACROSS = 200, 7  # [pixels] side of a picture; number of pictures in a row
CLOSE_CAMERA = replace(UPPER_BODY_CAMERA, distance=1.9, pivot=(0.05, 0.0, 1.22))
POSTURES: dict[str, tuple[float, dict[str, float]]] = {  # by label: camera yaw [deg], hinge angles [deg]
    "flexion 170": (30, {"shoulder_flexion": 170, "shoulder_abduct": 8, "sternoclavicular_abduct": 25}),
    "flexion 150": (60, {"shoulder_flexion": 150, "shoulder_abduct": 8}),
    "flexion 90": (60, {"shoulder_flexion": 90, "elbow_flexion": 0}),
    "back -50": (120, {"shoulder_flexion": -50, "shoulder_abduct": 20}),
    "abduct 120": (0, {"shoulder_abduct": 120, "sternoclavicular_abduct": 25}),
    "abduct 120, from behind": (180, {"shoulder_abduct": 120, "elbow_flexion": 0}),
    "flexion 150, abduct 60": (20, {"shoulder_flexion": 150, "shoulder_abduct": 60}),
    "arms crossed": (10, {"shoulder_flexion": 90, "shoulder_abduct": -40, "elbow_flexion": 20}),
    "shrug 25": (0, {"sternoclavicular_abduct": 25, "elbow_flexion": 60}),
    "twist 90": (20, {"shoulder_twisting": 90, "elbow_flexion": 90, "shoulder_abduct": 20}),
    "twist -90": (20, {"shoulder_twisting": -90, "elbow_flexion": 90, "shoulder_abduct": 20}),
    "flexion 170, twist 90": (30, {"shoulder_flexion": 170, "shoulder_twisting": 90, "shoulder_abduct": 8}),
    "elbow 135": (70, {"elbow_flexion": 135}),
    "elbow 135, forearm 85": (40, {"elbow_flexion": 135, "elbow_twisting": 85, "shoulder_flexion": 30}),
    "elbow 135, forearm -85": (40, {"elbow_flexion": 135, "elbow_twisting": -85, "shoulder_flexion": 30}),
    "forearm -85": (30, {"elbow_flexion": 90, "elbow_twisting": -85}),
    "forearm 85, wrist 60": (30, {"elbow_flexion": 90, "elbow_twisting": 85, "wrist_flexion": 60}),
    "forearm 0, wrist -60": (30, {"elbow_flexion": 90, "wrist_flexion": -60, "wrist_pivot": 30}),
    "neck 75, down 40": (0, {"skullbase_torsion": 75, "skullbase_tilt": 40, "skullbase_roll": 25}),
    "neck up 35": (60, {"skullbase_tilt": -35}),
    "waist 50, 35, 20": (20, {"vl5_torsion": 50, "vl5_tilt": 35, "vl5_roll": 20}),
}
SKELETON = Robot.load("human").skeleton


def drawn(blending: Blending) -> list[Picture]:
    """Draw all postures with one skinning method."""
    pictures = []
    with FigurePortrait(SKELETON, size=(SIDE, SIDE), blending=blending) as portrait:
        for name, (yaw, degrees) in POSTURES.items():
            angles = SKELETON.rest.copy()
            for hinge, angle in degrees.items():
                for k in [k for k, each in enumerate(SKELETON.names) if each in (hinge, f"l_{hinge}", f"r_{hinge}")]:
                    angles[k] = np.radians(angle)
            picture = Image.fromarray(portrait.draw(angles, {}, replace(CLOSE_CAMERA, yaw_deg=yaw)))
            ImageDraw.Draw(picture).text((5, 4), f"{blending}: {name}", fill=(230, 230, 230))
            pictures.append(np.asarray(picture))
    return pictures


linear, dual = drawn("linear"), drawn("dual")
rows = [
    np.concatenate(each[first : first + ACROSS], axis=1)
    for first in range(0, len(POSTURES), ACROSS)
    for each in (linear, dual)
]
sheet = Image.fromarray(np.concatenate(rows))
sheet.quantize(200).save(Path(__file__).parents[1] / "pictures" / "human-skin.png", optimize=True)

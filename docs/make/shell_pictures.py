"""Draw docs/pictures/shells.png: robots as their capsules and in their shells, and extreme postures."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.sim.film import write_still

PICTURE, CUT = (
    (720, 540),
    (140, 20, 620, 540),
)  # [pixels] width and height of a picture, and left, top, right and bottom of the part that is kept
WAVING_ANGLES = {  # [deg] hinge angles of a waving robot
    "r_shoulder_abduct": 40,
    "r_elbow_flexion": 110,
    "r_shoulder_twisting": 60,
    "l_elbow_flexion": 80,
}
EXTREME_ANGLES = (  # [deg] hinge angles of both arms in each posture
    {"shoulder_flexion": 90, "elbow_flexion": 135},
    {"vl5_tilt": 35, "skullbase_tilt": 40, "shoulder_flexion": -50},
    {"vl5_roll": 20, "skullbase_roll": -25, "shoulder_abduct": 90, "elbow_flexion": 90, "sternoclavicular_abduct": 25},
    {"vl5_torsion": 50, "skullbase_torsion": 75, "shoulder_flexion": 45, "elbow_flexion": 110, "wrist_flexion": 60},
)


def bent(robot: Robot, degrees: dict[str, float]) -> Floats:
    """Return a posture (n,) [rad] with all other hinges at rest."""
    angles = robot.skeleton.rest.copy()
    for name, angle in degrees.items():
        for k, each in enumerate(robot.skeleton.names):
            if each in (name, f"l_{name}", f"r_{name}"):
                angles[k] = np.radians(angle)
    return robot.skeleton.clamp(angles)


def still(robot: Robot, degrees: dict[str, float], folder: Path) -> Image.Image:
    """Draw a robot in one posture."""
    write_still(robot, bent(robot, degrees), folder / "still.png", size=PICTURE)
    with Image.open(folder / "still.png") as picture:
        return picture.crop(CUT).resize((360, 390), Image.Resampling.LANCZOS)


if __name__ == "__main__":
    robots = [Robot.load(name) for name in ("upper22", "upper36")]
    with TemporaryDirectory() as place:
        folder = Path(place)
        bare = [replace(robot, path=folder / "none.toml") for robot in robots]
        above = [still(robot, WAVING_ANGLES, folder) for pair in zip(bare, robots, strict=True) for robot in pair]
        below = [still(robots[1], degrees, folder) for degrees in EXTREME_ANGLES]
    sheet = np.concatenate([np.concatenate([np.asarray(one) for one in row], axis=1) for row in (above, below)])
    Image.fromarray(sheet).quantize(200).save(Path(__file__).parents[1] / "pictures" / "shells.png", optimize=True)

"""Draw the pictures of docs/how-to/write-a-gesture.md and docs/reference/gesture-files.md.

.venv/bin/python docs/make/gesture_guide.py    # writes docs/pictures/weigh_up.png and gesture_space.png
"""

import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from PIL import Image

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.space import SECTOR_CENTRES

DOCS = Path(__file__).parents[1]
GUIDE_PAGE = DOCS / "how-to" / "write-a-gesture.md"
PICTURE_FOLDER = DOCS / "pictures"
BODY_COLOUR = "#d5dbe2"
GRID_COLOUR = "#35648f"
ORIGIN_COLOUR = "#c0561f"
PICTURE_COLOURS = 128  # number of colours of a compressed picture
UP_LIMITS = (-1.0, 1.55)  # [arm lengths] visible heights
TITLE_GAP = 0.2  # [arm lengths] distance of the titles above the visible heights
BODY_LEFT_OF_SCREEN = -0.85  # [arm lengths] left edge of the front view


def render_example() -> None:
    """Draw the guide's gesture `weigh_up` by the guide's command."""
    lexicon = re.findall(r"```toml\n(.*?)```", GUIDE_PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]
    picture = PICTURE_FOLDER / "weigh_up.png"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mine.toml"
        file.write_text(lexicon, encoding="utf-8")
        words = ["kinesic", "gestures", "render", "weigh_up", "--lexicon", str(file), "--out", str(picture), "--force"]
        subprocess.run(words, check=True)
    compress(picture)


def compress(picture: Path) -> None:
    """Reduce a picture to `PICTURE_COLOURS` colours."""
    with Image.open(picture) as image:
        small = image.convert("RGB").quantize(PICTURE_COLOURS)
    small.save(picture, optimize=True)


def draw_body(axes: Axes, robot: Robot, horizontal: int) -> None:
    """Draw the standing robot's capsules [arm lengths] in a vertical plane."""
    frames = robot.body_frames(robot.skeleton.rest)
    for k, segment in enumerate(robot.skeleton.segments):
        for capsule in segment.capsules:
            ends = [frames.origins[k] + frames.rotations[k] @ end for end in (capsule.start, capsule.end)]
            points = [((end - robot.gesture_origin) / robot.arm_length)[[horizontal, 2]] for end in ends]
            fill_capsule(axes, points[0], points[1], capsule.radius / robot.arm_length)


def fill_capsule(axes: Axes, start: Floats, end: Floats, radius: float) -> None:
    """Fill the projection of a capsule."""
    for point in (start, end):
        axes.add_patch(Circle((float(point[0]), float(point[1])), radius, color=BODY_COLOUR, lw=0))
    length = float(np.linalg.norm(end - start))
    if length > 0:
        normal = radius * np.array([start[1] - end[1], end[0] - start[0]]) / length
        axes.add_patch(Polygon([start + normal, end + normal, end - normal, start - normal], color=BODY_COLOUR, lw=0))


def draw_space(robot: Robot) -> Figure:
    """Draw the gesture space over the robot, from front and right."""
    figure = Figure(figsize=(8.2, 4.6), dpi=100, facecolor="white")
    front, side = figure.subplots(1, 2, width_ratios=(1.25, 1), gridspec_kw={"wspace": 0.04})
    views = ((front, 1, "x", "outward", (BODY_LEFT_OF_SCREEN, 1.35)), (side, 0, "z", "forward", (-0.5, 1.35)))
    for axes, horizontal, axis, label, limits in views:
        draw_body(axes, robot, horizontal)
        axes.set_xlim(*limits)
        axes.set_ylim(*UP_LIMITS)
        axes.set_aspect("equal")
        axes.set_axis_off()
        draw_sectors(axes, axis)
        draw_origin(axes, label)
    for axes, title in ((front, "from the front, for the left hand"), (side, "from the robot's right side")):
        axes.text(axes.get_xlim()[0], UP_LIMITS[1] + TITLE_GAP, title, fontsize=10)
    label_heights(front)
    return figure


def draw_sectors(axes: Axes, axis: str) -> None:
    """Draw sector centres as dots, with the names along one axis."""
    for name, across in SECTOR_CENTRES[axis].items():
        heights = list(SECTOR_CENTRES["y"].values())
        axes.plot([across] * len(heights), heights, "o", color=GRID_COLOUR, ms=3.5)
        axes.plot([across, across], [min(heights), max(heights)], color=GRID_COLOUR, lw=0.5)
        axes.text(across, max(heights) + 0.06, f"{name} {across:g}", fontsize=7.5, rotation=60, color=GRID_COLOUR)
    ends = list(SECTOR_CENTRES[axis].values())
    for height in SECTOR_CENTRES["y"].values():
        axes.plot([min(ends), max(ends)], [height, height], color=GRID_COLOUR, lw=0.5)


def label_heights(axes: Axes) -> None:
    """Write the names of the heights beside the sectors."""
    for name, height in SECTOR_CENTRES["y"].items():
        axes.text(0.86, height, f"{name} {height:g}", fontsize=7.5, va="center", color=GRID_COLOUR)


def draw_origin(axes: Axes, label: str) -> None:
    """Draw the gesture space origin with an arrow along each axis."""
    axes.plot(0, 0, "o", color=ORIGIN_COLOUR, ms=7)
    for (x, y), name, offset in (((0.5, 0), label, (0.02, -0.12)), ((0, 0.5), "up", (0.04, -0.02))):
        style = {"arrowstyle": "-|>", "color": ORIGIN_COLOUR, "lw": 2}
        axes.annotate("", (x, y), (0, 0), arrowprops=style)
        box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1}
        axes.text(x + offset[0], y + offset[1], name, color=ORIGIN_COLOUR, fontsize=10, weight="bold", bbox=box)


if __name__ == "__main__":
    render_example()
    file = PICTURE_FOLDER / "gesture_space.png"
    draw_space(Robot.load()).savefig(file, bbox_inches="tight", pad_inches=0.1)
    compress(file)

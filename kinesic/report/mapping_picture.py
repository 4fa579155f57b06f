"""Picture of a robot's joint mapping with a label per hinge.

It shows the robot from the front.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.report.silhouette import OWNER_COLOURS, OutlineWindow, outline_lines, project, silhouette

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_NAME_LENGTH = 32  # [characters] length from which a joint name is cut in the picture
LABEL_PITCH = 0.3  # [in] vertical distance between labels
LABEL_WIDTH = 2.6  # [in] width of each column of labels
LEADER_WIDTH = 0.9  # [in] horizontal space for the leader lines between labels and robot
MIN_ROBOT_HEIGHT = 4.5  # [in] smallest height of the drawn robot
MAX_ROBOT_ASPECT = 1.2  # largest width / height of the drawn robot
TITLE_HEIGHT = 0.9  # [in] height of the title and the headings of both columns
MARGIN_HEIGHT = 0.2  # [in] free height below the robot
DOT_SIZE = 5.0  # [pt] diameter of a hinge's dot
POINTS_PER_INCH = 72  # typographic points per inch
PICTURE_DOTS = 120  # [1/in] resolution of the picture
TEXT_COLOUR = "#222222"  # colour of joint names
HINGE_COLOUR = "#777777"  # colour of hinge names
DOUBT_COLOUR = "#b00020"  # colour of the title of a doubtful mapping
MIDLINE_OWNER = "trunk"  # owner of hinges that belong to neither arm


@dataclass(frozen=True, eq=False)
class HingeLabel:
    """Label of one hinge of the picture."""

    joint: str  # name of the joint in the imported file
    hinge: str
    owner: str  # trunk, l or r
    point: Floats  # (2,) [m] position of the hinge in the drawing plane


def place_labels(robot: Robot, joint_of: Sequence[tuple[str, str]]) -> tuple[list[HingeLabel], list[HingeLabel]]:
    """Return the labels of the left and the right column, topmost first.

    The viewer sees the robot from the front, so the robot's right arm has the left column. Hinges of neither arm fill
    the shorter column.

    Args:
        robot: imported robot.
        joint_of: pairs of hinge and joint of the imported file.
    """
    skeleton = robot.skeleton
    frames = skeleton.frames(skeleton.rest)
    owners = {segment: side for side in SIDES for segment in robot.arm(side).segments}
    columns: dict[str, list[HingeLabel]] = {"l": [], "r": [], MIDLINE_OWNER: []}
    for hinge_name, joint in joint_of:
        hinge = skeleton.hinges[skeleton.joint(hinge_name)]
        k = skeleton.segment(hinge.segment)
        owner = owners.get(hinge.segment, MIDLINE_OWNER)
        point = project(frames.origins[k] + frames.rotations[k] @ hinge.at)
        columns[owner].append(HingeLabel(joint, hinge_name, owner, point))
    for label in columns[MIDLINE_OWNER]:
        min(columns["r"], columns["l"], key=len).append(label)
    left, right = (sorted(columns[side], key=lambda label: -float(label.point[1])) for side in ("r", "l"))
    return left, right


def draw_mapping(
    robot: Robot, joint_of: Sequence[tuple[str, str]], path: Path, *, confidence: float, doubtful: bool
) -> None:
    """Draw the robot from the front with joint and hinge names.

    Args:
        robot: imported robot, drawn in its rest posture.
        joint_of: pairs of hinge and joint of the imported file.
        path: PNG file to write.
        confidence: confidence in the mapping, 0 to 1.
        doubtful: whether the title asks for a review.

    Raises:
        ModuleNotFoundError: matplotlib is missing.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - an extra
    from matplotlib.collections import LineCollection  # noqa: PLC0415 - an extra
    from matplotlib.figure import Figure  # noqa: PLC0415 - an extra

    left, right = place_labels(robot, joint_of)
    owners = {label.owner for label in (*left, *right)} | {MIDLINE_OWNER}  # without an arm that the robot lacks
    posture = silhouette(robot, robot.skeleton.rest, {}, with_base=True)
    lines = outline_lines([line for line in posture if line.owner in owners])
    window = OutlineWindow.around(lines)
    tall = max(MIN_ROBOT_HEIGHT, LABEL_PITCH * max(len(left), len(right)))
    scale = min(tall / window.tall, MAX_ROBOT_ASPECT * tall / window.wide)  # [in/m]
    middle = LABEL_WIDTH + LEADER_WIDTH + scale * window.wide / 2
    corner = np.array([middle, MARGIN_HEIGHT + (tall - scale * window.tall) / 2 - scale * window.low])
    width, height = 2 * middle, tall + TITLE_HEIGHT + MARGIN_HEIGHT
    paper = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(paper)
    axes = paper.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, width), ylim=(0, height))
    axes.set_axis_off()
    axes.add_collection(
        LineCollection(
            [scale * line.points + corner for line in lines],
            linewidths=[line.width * scale * POINTS_PER_INCH for line in lines],
            colors=[line.colour for line in lines],
            capstyle="round",
            joinstyle="round",
        ),
        autolim=False,
    )
    title = f"{robot.name}: confidence of the joint mapping {confidence:.2f} of 1" + ", review it" * doubtful
    title_colour = DOUBT_COLOUR if doubtful else TEXT_COLOUR
    axes.text(middle, height - 0.3, title, ha="center", color=title_colour, weight="bold", parse_math=False)
    top = MARGIN_HEIGHT + tall
    for column, x, side, alignment in (
        (left, LABEL_WIDTH, "right", "right"),
        (right, width - LABEL_WIDTH, "left", "left"),
    ):
        axes.text(x, top + 0.2, f"{side} side of the robot", ha=alignment, color=OWNER_COLOURS[side[0]], fontsize=9)
        _draw_column(axes, column, x, alignment, [scale * label.point + corner for label in column], (top, tall))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the font may lack characters of a joint name
        paper.savefig(path, dpi=PICTURE_DOTS, format="png", metadata={"Software": None})


def _draw_column(
    axes: "Axes",
    column: Sequence[HingeLabel],
    x: float,
    alignment: str,
    points: Sequence[Floats],
    area: tuple[float, float],
) -> None:
    """Draw one column of labels with leader lines to the hinges.

    Args:
        axes: axes in inches.
        column: labels, topmost first.
        x: [in] edge of the column towards the robot.
        alignment: alignment of the texts at this edge.
        points: [in] positions of the hinges.
        area: [in] top and height of the column.
    """
    top, tall = area
    outward = 0.06 if alignment == "left" else -0.06  # [in] gap between the leader line and its text
    heights = spread_labels([float(point[1]) for point in points], top - LABEL_PITCH / 2, top - tall + LABEL_PITCH / 2)
    for label, point, y in zip(column, points, heights, strict=True):
        colour = OWNER_COLOURS[label.owner]
        axes.plot([x, point[0]], [y, point[1]], color=colour, linewidth=0.7, alpha=0.8)
        axes.plot(point[0], point[1], "o", color=colour, markersize=DOT_SIZE, markeredgecolor="white")
        for text, edge, ink, size in (
            (_spell_name(label.joint), "bottom", TEXT_COLOUR, 9),
            (label.hinge, "top", HINGE_COLOUR, 7),
        ):
            axes.text(x + outward, y, text, ha=alignment, va=edge, color=ink, fontsize=size, parse_math=False)


def spread_labels(heights: Sequence[float], top: float, bottom: float) -> list[float]:
    """Return heights [in] of labels, at least `LABEL_PITCH` apart.

    Each label stays as near to its hinge as its neighbours allow.

    Args:
        heights: heights of the hinges [in], topmost first.
        top: [in] largest height of a label.
        bottom: [in] smallest height of a label; the labels fit between top and bottom.
    """
    spread: list[float] = []
    for k, height in enumerate(heights):
        centred = height + LABEL_PITCH * (heights.count(height) - 1) / 2  # labels of one point are centred on it
        highest = spread[-1] - LABEL_PITCH if spread else top
        lowest = bottom + LABEL_PITCH * (len(heights) - 1 - k)
        spread.append(max(min(centred, highest), lowest))
    return spread


def _spell_name(name: str) -> str:
    """Return a joint name as printable text of limited length."""
    printable = "".join(character if character.isprintable() else "?" for character in name)
    return printable if len(printable) <= MAX_NAME_LENGTH else f"{printable[: MAX_NAME_LENGTH - 3]}..."

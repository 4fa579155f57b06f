"""The skin of a figure as the scripts of pages draw it: a mesh with its colours, and the frames that move it."""

from base64 import b64encode
from functools import cache

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Skeleton
from kinesic.face.assets.body import FRAMES_PER_VERTEX, POSITION_STEP, DressedPerson, load_figure
from kinesic.face.assets.chart import chart_window, mouth, vertex_chart
from kinesic.face.assets.mesh import PARTS, MeshPart
from kinesic.face.assets.paint import COMPLEXIONS, RESOLUTION, skin
from kinesic.face.assets.rig import FRAMES, PLACE, SkinningFrame
from kinesic.face.assets.skinning import TWIST, Skin
from kinesic.report.gltf.skin import HAIRLINE, PLAIN_COLOURS, screen_colours
from kinesic.report.report import Json

KINDS: dict[MeshPart, int] = {"cloth": 1, "eyes": 2}  # of vertices, for the shader; 0 is any other
EYES = (0.10, 0.17, 0.16), (0.74, 0.70, 0.67)  # linear: the iris, and what is white
INNER, SHADED = 0.9, 0.45  # how much darker skin inside the mouth is, and how much light teeth and tongue get
BORDER = 0.32767  # [m] beyond the border of cloth, at most
DIGITS = 6  # of rotations and places [m] of frames
VERTEX = np.dtype(
    [
        ("place", "<i2", 4),  # POSITION_STEP [m], and nothing
        ("normal", "i1", 3),
        ("kind", "i1"),
        ("colour", "u1", 4),  # as screens have it, and nothing
        ("mark", "<i2", 2),  # of cloth: share of BORDER beyond its border; of eyes: left and up from their middle
        ("joints", "u1", FRAMES_PER_VERTEX),
        ("weights", "u1", FRAMES_PER_VERTEX),
    ]
)


def skin_data(robot: Robot) -> dict[str, Json]:
    """Gathers what `skinOf` reads of a robot that has a skin."""
    figure = load_figure()
    vertices, triangles = _packed()
    return {
        "bones": _bones(Skin(figure, robot.skeleton), robot.skeleton),
        "vertices": vertices,
        "triangles": triangles,
        "size": VERTEX.itemsize,
        "step": POSITION_STEP,
        "border": BORDER,
        "head": PLACE["skullbase"],
        "eyeballs": [[round(float(value), DIGITS) for value in centre] for centre in figure.mesh.eyes],
        "eyes": [[round(float(value), 3) for value in screen_colours(np.array(colour))] for colour in EYES],
    }


def _bones(skin_of: Skin, skeleton: Skeleton) -> list[Json]:
    """Of each frame: its segment and that one's parent, its share of the turn, hinges, and the way back from bind."""
    found: list[Json] = []
    for frame, unbound, centre in zip(skin_of.frames, skin_of.unbound, skin_of.centres, strict=True):
        segment = skeleton.segment(frame.segment)
        back = np.column_stack([unbound, -unbound @ centre])
        found.append(
            {
                "segment": segment,
                "parent": skeleton.steps[segment][0],
                "share": frame.share,
                "turns": _turns(frame, skeleton),
                "back": [round(float(value), DIGITS) + 0.0 for value in back.ravel()],
            }
        )
    return found


def _turns(frame: SkinningFrame, skeleton: Skeleton) -> list[Json]:
    """Hinges with their axes, and which share of a twist is taken; none where the segment moves the skin as it is."""
    if (frame.share, frame.twist) == (1, 1):
        return []
    return [
        {
            "hinge": k,
            "axis": [float(value) for value in hinge.axis],
            **({"twist": frame.twist} if hinge.name.endswith(TWIST) else {}),
        }
        for k, hinge in enumerate(skeleton.hinges)
        if hinge.segment == frame.segment
    ]


@cache
def _packed() -> tuple[str, str]:
    """Vertices as rows of VERTEX, and three 16-bit corners for each triangle, both in base64."""
    figure = load_figure()
    mesh = figure.mesh
    normals = mesh.normals(mesh.positions)
    rows = np.zeros(len(mesh.positions), dtype=VERTEX)
    rows["place"][:, :3] = np.rint((mesh.positions + normals * figure.hair[:, None]) / POSITION_STEP)
    rows["normal"] = np.rint(127 * normals)
    rows["colour"][:, :3] = np.rint(255 * screen_colours(_colours(figure)))
    for part, kind in KINDS.items():
        rows["kind"][mesh.vertices(part)] = kind
    rows["mark"] = np.rint(np.iinfo(np.int16).max * _marks(figure).clip(-1.0, 1.0))
    rows["joints"], rows["weights"] = _influences(figure)
    triangles = mesh.triangles.astype("<u2")
    return b64encode(rows.tobytes()).decode(), b64encode(triangles.tobytes()).decode()


def _colours(figure: DressedPerson) -> Floats:
    """(v, 3) linear."""
    mesh, complexion, chart = figure.mesh, COMPLEXIONS["female"], vertex_chart(figure.mesh)
    wide, high, left, low = chart_window()
    across = np.clip(chart[:, :2] * (wide, high) + (left, low), 0.0, 1.0)
    columns, rows = np.rint(across * (RESOLUTION - 1)).astype(np.intp).T
    found = skin(complexion)[rows, columns, :3].copy()
    t = np.clip((chart[:, 3] - HAIRLINE[0]) / (HAIRLINE[1] - HAIRLINE[0]), 0.0, 1.0)
    found += (t * t * (3 - 2 * t))[:, None] * (np.asarray(complexion.hair) - found)
    found *= 1.0 - INNER * mouth(mesh)[:, None]
    for part, colour in PLAIN_COLOURS.items():
        found[mesh.parts == PARTS.index(part)] = np.array(colour) * (SHADED if part in ("teeth", "tongue") else 1.0)
    assert mesh.plain is not None  # a figure has it
    cloth = mesh.parts == PARTS.index("cloth")
    found[cloth] = mesh.plain[cloth, :3] ** 2
    return found


def _marks(figure: DressedPerson) -> Floats:
    """(v, 2) -1..1."""
    mesh = figure.mesh
    found = np.zeros((len(mesh.positions), 2))
    eyes, cloth = mesh.vertices("eyes"), mesh.vertices("cloth")
    found[eyes] = vertex_chart(mesh)[eyes, :2]
    found[cloth, 0] = mesh.tips[cloth] / BORDER
    return found


def _influences(figure: DressedPerson) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
    """(v, 8) frames that move each vertex, after them left and right eye, and (v, 8) how much; it adds up to 255."""
    rows = figure.weights.toarray()
    places = np.argsort(-rows, axis=1)[:, :FRAMES_PER_VERTEX]
    shares = 255 * np.take_along_axis(rows, places, axis=1)
    whole = np.rint(shares).astype(np.intp)
    whole[:, 0] += 255 - whole.sum(axis=1)  # the strongest takes what rounding left
    eyes = figure.mesh.vertices("eyes")
    places[eyes, 0] = len(FRAMES) + (figure.mesh.positions[eyes, 1] < 0.0)  # the head alone moves them
    return places, whole.astype(np.uint8)

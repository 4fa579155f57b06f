"""Skin of the human figure for pages: coloured mesh and rig frames."""

from base64 import b64encode
from functools import cache

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Skeleton
from kinesic.face.assets.body import MAX_FRAMES_PER_VERTEX, POSITION_STEP, DressedPerson, load_figure
from kinesic.face.assets.chart import compute_chart_window, compute_vertex_chart, measure_mouth_depth
from kinesic.face.assets.mesh import MESH_PARTS, MeshPart
from kinesic.face.assets.paint import COMPLEXIONS, SKIN_RESOLUTION, paint_skin
from kinesic.face.assets.rig import FRAME_INDICES, SKINNING_FRAMES, SkinningFrame
from kinesic.face.assets.skinning import TWIST_SUFFIX, Skin
from kinesic.report.gltf.skin import HAIRLINE_RANGE, PLAIN_COLOURS
from kinesic.report.gltf.skin_pictures import screen_colours, shade_locks
from kinesic.report.report import Json

VERTEX_KINDS: dict[MeshPart, int] = {"cloth": 1, "eyes": 2}  # shader codes by mesh part; other parts have 0
EYE_COLOURS = (0.10, 0.17, 0.16), (0.74, 0.70, 0.67)  # linear RGB colours of iris and sclera
MOUTH_DARKENING = 0.9  # fraction by which skin inside the mouth is darkened
TEETH_BRIGHTNESS = 0.45  # factor on the linear colours of teeth and tongue
MAX_BORDER_DISTANCE = 0.32767  # [m] largest stored distance of a cloth vertex beyond the garment's border
FRAME_DIGITS = 6  # decimal places of rig frame rotations and positions [m]
# Bytes of one packed vertex, as the page's shader reads them.
VERTEX_TYPE = np.dtype(
    [
        ("place", "<i2", 4),  # multiples of POSITION_STEP; the last is padding
        ("normal", "i1", 3),
        ("kind", "i1"),
        ("colour", "u1", 4),  # sRGB; the last is padding
        ("mark", "<i2", 2),  # cloth: distance beyond its border / MAX_BORDER_DISTANCE; eyes: left and up of centre
        ("joints", "u1", MAX_FRAMES_PER_VERTEX),
        ("weights", "u1", MAX_FRAMES_PER_VERTEX),
    ]
)


def skin_data(robot: Robot) -> dict[str, Json]:
    """Return the human figure's skin, bound to a robot, for page scripts."""
    figure = load_figure()
    vertices, triangles = _packed()
    return {
        "bones": _bones(Skin(figure, robot.skeleton), robot.skeleton),
        "vertices": vertices,
        "triangles": triangles,
        "size": VERTEX_TYPE.itemsize,
        "step": POSITION_STEP,
        "border": MAX_BORDER_DISTANCE,
        "head": FRAME_INDICES["skullbase"],
        "eyeballs": [[round(float(value), FRAME_DIGITS) for value in centre] for centre in figure.mesh.eyes],
        "eyes": [[round(float(value), 3) for value in screen_colours(np.array(colour))] for colour in EYE_COLOURS],
    }


def _bones(skin_of: Skin, skeleton: Skeleton) -> list[Json]:
    """Pack each rig frame: segment, parent, rotation weight, hinges, bind pose."""
    bones: list[Json] = []
    for frame, unbound, centre in zip(skin_of.frames, skin_of.inverse_bind_rotations, skin_of.centres, strict=True):
        segment = skeleton.segment(frame.segment)
        back = np.column_stack([unbound, -unbound @ centre])
        bones.append(
            {
                "segment": segment,
                "parent": skeleton.steps[segment][0],
                "share": frame.rotation_fraction,
                "turns": _turns(frame, skeleton),
                "back": [round(float(value), FRAME_DIGITS) + 0.0 for value in back.ravel()],
            }
        )
    return bones


def _turns(frame: SkinningFrame, skeleton: Skeleton) -> list[Json]:
    """List a rig frame's hinges, empty if it follows the whole segment."""
    if (frame.rotation_fraction, frame.twist) == (1, 1):
        return []
    return [
        {
            "hinge": k,
            "axis": [float(value) for value in hinge.axis],
            **({"twist": frame.twist} if hinge.name.endswith(TWIST_SUFFIX) else {}),
        }
        for k, hinge in enumerate(skeleton.hinges)
        if hinge.segment == frame.segment
    ]


@cache
def _packed() -> tuple[str, str]:
    """Encode the figure's vertices and triangle corners in base64."""
    figure = load_figure()
    mesh = figure.mesh
    normals = mesh.normals(mesh.positions)
    rows = np.zeros(len(mesh.positions), dtype=VERTEX_TYPE)
    rows["place"][:, :3] = np.rint((mesh.positions + normals * figure.hair[:, None]) / POSITION_STEP)
    rows["normal"] = np.rint(127 * normals)
    rows["colour"][:, :3] = np.rint(255 * screen_colours(_colours(figure)))
    for part, kind in VERTEX_KINDS.items():
        rows["kind"][mesh.vertices(part)] = kind
    rows["mark"] = np.rint(np.iinfo(np.int16).max * _marks(figure).clip(-1.0, 1.0))
    rows["joints"], rows["weights"] = _influences(figure)
    triangles = np.concatenate([mesh.triangles, len(rows) + figure.locks.triangles]).astype("<u2")
    whole = np.concatenate([rows, _pack_locks(figure)])
    return b64encode(whole.tobytes()).decode(), b64encode(triangles.tobytes()).decode()


def _pack_locks(figure: DressedPerson) -> NDArray[np.void]:
    """Return the vertices of the locks of hair, which follow the head."""
    locks = figure.locks
    rows = np.zeros(len(locks.positions), dtype=VERTEX_TYPE)
    rows["place"][:, :3] = np.rint(locks.positions / POSITION_STEP)
    rows["normal"] = np.rint(127 * locks.normals)
    rows["colour"][:, :3] = np.rint(255 * screen_colours(shade_locks(locks)))
    rows["joints"][:, 0], rows["weights"][:, 0] = FRAME_INDICES["skullbase"], 255
    return rows


def _colours(figure: DressedPerson) -> Floats:
    """Return the linear RGB colour of each vertex, (v, 3)."""
    mesh, complexion, chart = figure.mesh, COMPLEXIONS["female"], compute_vertex_chart(figure.mesh)
    wide, high, left, low = compute_chart_window()
    across = np.clip(chart[:, :2] * (wide, high) + (left, low), 0.0, 1.0)
    columns, rows = np.rint(across * (SKIN_RESOLUTION - 1)).astype(np.intp).T
    colours = paint_skin(complexion)[rows, columns, :3].copy()
    t = np.clip((chart[:, 3] - HAIRLINE_RANGE[0]) / (HAIRLINE_RANGE[1] - HAIRLINE_RANGE[0]), 0.0, 1.0)
    colours += (t * t * (3 - 2 * t))[:, None] * (np.asarray(complexion.hair) - colours)
    colours *= 1.0 - MOUTH_DARKENING * measure_mouth_depth(mesh)[:, None]
    for part, colour in PLAIN_COLOURS.items():
        colours[mesh.parts == MESH_PARTS.index(part)] = np.array(colour) * (
            TEETH_BRIGHTNESS if part in ("teeth", "tongue") else 1.0
        )
    assert mesh.plain is not None  # a figure has it
    cloth = mesh.parts == MESH_PARTS.index("cloth")
    colours[cloth] = mesh.plain[cloth, :3] ** 2
    return colours


def _marks(figure: DressedPerson) -> Floats:
    """Return per-vertex shader inputs for eyes and cloth, (v, 2)."""
    mesh = figure.mesh
    marks = np.zeros((len(mesh.positions), 2))
    eyes, cloth = mesh.vertices("eyes"), mesh.vertices("cloth")
    marks[eyes] = compute_vertex_chart(mesh)[eyes, :2]
    marks[cloth, 0] = mesh.tips[cloth] / MAX_BORDER_DISTANCE
    return marks


def _influences(figure: DressedPerson) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
    """Return eight rig frames and their weights per vertex, (v, 8) each.

    The eyes follow after all rig frames, left before right. The weights of a vertex add up to 255.
    """
    rows = figure.weights.toarray()
    places = np.argsort(-rows, axis=1)[:, :MAX_FRAMES_PER_VERTEX]
    shares = 255 * np.take_along_axis(rows, places, axis=1)
    whole = np.rint(shares).astype(np.intp)
    whole[:, 0] += 255 - whole.sum(axis=1)  # the strongest takes what rounding left
    eyes = figure.mesh.vertices("eyes")
    places[eyes, 0] = len(SKINNING_FRAMES) + (figure.mesh.positions[eyes, 1] < 0.0)  # the head alone moves them
    return places, whole.astype(np.uint8)

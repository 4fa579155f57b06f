import numpy as np
import pytest

from kinesic.body.choices import Variant
from kinesic.face.assets.action_units import deform
from kinesic.face.assets.chart import measure_mouth_depth
from kinesic.face.assets.lips import find_lips
from kinesic.face.assets.mesh import FACE_VARIANTS, Mesh, load_head
from kinesic.face.assets.sculpt import even_out
from kinesic.face.render.wrinkles import load_wrinkles

SMOOTHED_CENTRE = (0.68, -1.0)  # lateral position and height, in distances between the eyes
SMOOTHED_RADIUS = 0.22


def edges_beside_the_mouth(mesh: Mesh) -> np.ndarray:
    """Return the (e, 2) ends of skin edges next to the mouth."""
    ends = np.sort(np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    ends = np.unique(ends, axis=0)
    woman = load_head()
    middle = woman.positions[ends].mean(axis=1) / (woman.eyes[0, 1] - woman.eyes[1, 1])
    near = np.hypot(np.abs(middle[:, 1]) - SMOOTHED_CENTRE[0], middle[:, 2] - SMOOTHED_CENTRE[1]) < SMOOTHED_RADIUS
    outside = (mesh.parts[ends] == 0).all(axis=1) & (measure_mouth_depth(mesh)[ends] == 0.0).all(axis=1)
    return np.asarray(ends[near & outside & (middle[:, 0] > 0.0)])


@pytest.mark.parametrize("variant", FACE_VARIANTS)
@pytest.mark.parametrize("units", [{"12": 1.0}, {"6": 0.8, "12": 0.9, "25": 0.8}], ids=["12", "6+12+25"])
def test_smile_keeps_skin_next_to_the_mouth_smooth(variant: Variant, units: dict[str, float]):
    """Expect less than the 23 degrees between neighbours in the source mesh.

    There, edges also shrink to less than half their length.
    """
    mesh = load_head(variant)
    one, other = edges_beside_the_mouth(mesh).T
    smiling = deform(mesh, units)
    lengths = [np.linalg.norm(item[one] - item[other], axis=1) for item in (mesh.positions, smiling)]
    assert len(one) > 50
    assert np.min(lengths[1] / lengths[0]) > 0.6
    normals = mesh.normals(smiling)
    assert np.degrees(np.arccos(np.sum(normals[one] * normals[other], axis=1))).max() < 13.0


def test_only_skin_next_to_the_mouth_is_smoothed_in_smiles():
    head = load_head()
    moves = np.random.default_rng(5).normal(size=head.positions.shape)
    np.testing.assert_array_equal(even_out("mouthFrownLeft", moves, head), moves)
    evened = even_out("mouthSmileLeft", moves, head)
    changed = np.flatnonzero((evened != moves).any(axis=1))
    unit = head.eyes[0, 1] - head.eyes[1, 1]
    assert len(changed) > 50
    assert (head.parts[changed] == 0).all()
    assert head.positions[changed, 1].min() > 0.42 * unit
    assert evened[changed].std() < 0.7 * moves[changed].std()


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_cheek_raiser_unit_bulges_the_cheek_outward_by_more_than_3_mm(variant: Variant):
    """Expect a mean outward displacement of more than 3 mm."""
    mesh = load_head(variant)
    rest = mesh.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    cheek = (mesh.parts == 0) & (np.hypot(np.abs(rest[:, 1]) - 0.55, rest[:, 2] + 0.4) < 0.1) & (rest[:, 0] > 0.0)
    moved = (deform(mesh, {"6": 1.0}) - mesh.positions)[cheek]
    assert np.sum(moved * mesh.normals(mesh.positions)[cheek], axis=1).mean() > 0.003
    assert moved[:, 2].mean() > 0.006


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_smiling_lips_rest_on_the_teeth_without_sagging(variant: Variant):
    mesh = load_head(variant)
    rest = mesh.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    middle = (mesh.parts == 0) & (np.abs(rest[:, 1]) < 0.05) & (rest[:, 0] > 0.2) & (np.abs(rest[:, 2] + 1.1) < 0.4)
    assert (deform(mesh, {"12": 1.0}) - mesh.positions)[middle, 0].mean() < -0.001
    actual = find_lips(mesh)
    points = actual.points[: actual.starts[1]] @ deform(mesh, {"6": 0.8, "12": 0.9, "25": 0.8})
    edge = [points[np.abs(points[:, 1] - at) < 0.001, 2].min() for at in actual.middles[8:17]]
    assert max(edge) - edge[4] < 0.0010


@pytest.mark.parametrize("variant", FACE_VARIANTS)
@pytest.mark.parametrize("units", [{"22": 1.0}, {"22": 1.0, "25": 1.0}], ids=["22", "22+25"])
def test_rounded_lips_open_as_arcs(variant: Variant, units: dict[str, float]):
    """Expect curved lips instead of the straight V in the source."""
    mesh = load_head(variant)
    lips, unit = find_lips(mesh), float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
    points = lips.points @ deform(mesh, units)
    for lip, innermost in ((points[: lips.starts[1]], np.min), (points[lips.starts[1] :], np.max)):
        middle, halfway, aside = (
            innermost(lip[np.abs(np.abs(lip[:, 1]) - at * unit) < 0.001, 2]) for at in (0.0, 0.09, 0.2)
        )
        assert abs(aside - middle) > 0.003
        assert abs(halfway - middle) < 0.33 * abs(aside - middle)


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_corners_of_an_open_mouth_are_smooth(variant: Variant):
    """Limit the angle between neighbouring triangles, 170 degrees in the source."""
    mesh, woman = load_head(variant), load_head()
    rest = woman.positions / (woman.eyes[0, 1] - woman.eyes[1, 1])
    near = (mesh.parts == 0) & (np.hypot(np.abs(rest[:, 1]) - 0.40, rest[:, 2] + 1.09) < 0.06) & (rest[:, 0] > 0.33)
    faces = mesh.faces[near[mesh.faces].all(axis=1)]
    opened = deform(mesh, {"26": 1.0, "25": 1.0})
    a, b, c, d = opened[faces].transpose(1, 0, 2)
    normals = np.cross(c - a, d - b)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    cosines = np.einsum("fi,fvi->fv", normals, mesh.normals(opened)[faces])
    assert len(faces) > 40
    assert np.degrees(np.arccos(cosines.min())) < 45.0


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_smiling_lips_curve_towards_the_corners(variant: Variant):
    """Prevent a V, with a straight rise from the middle."""
    mesh = load_head(variant)
    lips, unit = find_lips(mesh), float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
    points = (lips.points @ deform(mesh, {"6": 0.8, "12": 0.9}))[lips.starts[1] :]
    middle, halfway, corner = (
        points[np.abs(np.abs(points[:, 1]) - at * unit) < 0.001, 2].max() for at in (0.0, 0.18, 0.36)
    )
    assert corner - middle > 0.004
    assert halfway - middle < 0.35 * (corner - middle)


def test_forehead_furrows_of_the_inner_and_outer_brow_raiser_join_at_equal_height():
    """Prevent furrows with a step where inner and outer halves join."""
    inner, outer = (next(item for item in load_wrinkles() if item.unit == unit).curves for unit in (1, 2))
    for one, other in zip(inner, outer, strict=False):
        end, start = one.points[-1], other.points[0]
        assert abs(np.interp(start[0], *one.points.T) - start[1]) < 0.02
        assert end[0] > start[0]

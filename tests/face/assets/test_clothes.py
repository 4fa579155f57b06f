import numpy as np
import pytest

from kinesic.face.assets.body import load_figure
from kinesic.face.assets.clothes import ANKLE_HEIGHT, CUFF_POSITION, HEM_HEIGHT, WAIST_HEIGHT, cut_garments
from kinesic.face.assets.mesh import MESH_PARTS

JOINT_CENTRES = load_figure().centres
PELVIS_CENTRE = JOINT_CENTRES["humanoid_root"]


def beyond(point: np.ndarray) -> list[bool]:
    """Return which of shirt, trousers and shoes end before a point."""
    return [bool(garment.beyond[0] > 0.0) for garment in cut_garments(point[None], JOINT_CENTRES)]


def test_shirt_trousers_and_shoes_end_at_waist_hem_and_ankle():
    front = np.array([0.1, 0.0, 0.0])
    assert beyond(PELVIS_CENTRE + front + (0, 0, WAIST_HEIGHT + 0.1)) == [False, True, True]
    assert beyond(PELVIS_CENTRE + front + (0, 0, HEM_HEIGHT - 0.1)) == [True, False, True]
    assert beyond(PELVIS_CENTRE + front + (0, 0, ANKLE_HEIGHT - 0.05)) == [True, True, False]
    assert beyond(JOINT_CENTRES["skullbase"]) == [True, True, True]
    elbow, wrist = JOINT_CENTRES["l_elbow"], JOINT_CENTRES["l_wrist"]
    assert beyond(elbow + (CUFF_POSITION - 0.05) * (wrist - elbow)) == [False, True, True]
    assert beyond(elbow + (CUFF_POSITION + 0.05) * (wrist - elbow)) == [True, True, True]


def test_shirt_trousers_and_shoes_overlap_without_gaps():
    heights = np.linspace(-0.8, 0.3, 200)
    column = PELVIS_CENTRE + np.stack([np.zeros(200), np.full(200, 0.1), heights], axis=1)
    worn = np.array([garment.beyond < 0.0 for garment in cut_garments(column, JOINT_CENTRES)])
    assert worn.any(axis=0).all()
    assert (worn[0] & worn[1]).any()
    assert (worn[1] & worn[2]).any()


def test_shirt_covers_the_top_of_the_trousers():
    point = PELVIS_CENTRE[None] + (0.1, 0.0, 0.03)
    shirt, trousers, _ = cut_garments(point, JOINT_CENTRES)
    assert shirt.offset[0] > trousers.offset[0] + 0.005


@pytest.mark.parametrize("side", ["l", "r"])
def test_shirt_cuff_is_1_to_7_mm_outside_the_skin_of_the_wrist(side: str):
    """Prevent a wide gap, which shows the dark inside of the sleeve."""
    mesh, elbow = load_figure().mesh, JOINT_CENTRES[f"{side}_elbow"]
    bone = JOINT_CENTRES[f"{side}_wrist"] - elbow
    along = (mesh.positions - elbow) @ bone / (bone @ bone)
    away = np.linalg.norm(mesh.positions - elbow - along[:, None] * bone, axis=1)
    near = (away < 0.06) & (along > 0.84) & (along < 0.97)
    cloth, skin = (near & (mesh.parts == MESH_PARTS.index(part)) for part in ("cloth", "skin"))
    assert 0.001 < away[cloth].mean() - away[skin].mean() < 0.007

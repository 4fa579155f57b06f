import numpy as np
import pytest

from kinesic.face.assets.body import load_figure
from kinesic.face.assets.clothes import ANKLE, CUFF, HEM, WAIST, garments
from kinesic.face.assets.mesh import PARTS

CENTRES = load_figure().centres
PELVIS = CENTRES["humanoid_root"]


def beyond(point: np.ndarray) -> list[bool]:
    """Which of shirt, trousers and shoes end before a point."""
    return [bool(garment.beyond[0] > 0.0) for garment in garments(point[None], CENTRES)]


def test_each_part_of_the_body_wears_what_it_should():
    front = np.array([0.1, 0.0, 0.0])
    assert beyond(PELVIS + front + (0, 0, WAIST + 0.1)) == [False, True, True]
    assert beyond(PELVIS + front + (0, 0, HEM - 0.1)) == [True, False, True]
    assert beyond(PELVIS + front + (0, 0, ANKLE - 0.05)) == [True, True, False]
    assert beyond(CENTRES["skullbase"]) == [True, True, True]
    elbow, wrist = CENTRES["l_elbow"], CENTRES["l_wrist"]
    assert beyond(elbow + (CUFF - 0.05) * (wrist - elbow)) == [False, True, True]
    assert beyond(elbow + (CUFF + 0.05) * (wrist - elbow)) == [True, True, True]


def test_garments_overlap_so_that_no_skin_is_missed():
    heights = np.linspace(-0.8, 0.3, 200)
    column = PELVIS + np.stack([np.zeros(200), np.full(200, 0.1), heights], axis=1)
    worn = np.array([garment.beyond < 0.0 for garment in garments(column, CENTRES)])
    assert worn.any(axis=0).all()
    assert (worn[0] & worn[1]).any()
    assert (worn[1] & worn[2]).any()


def test_the_shirt_hangs_over_the_trousers():
    point = PELVIS[None] + (0.1, 0.0, 0.03)
    shirt, trousers, _ = garments(point, CENTRES)
    assert shirt.offset[0] > trousers.offset[0] + 0.005


@pytest.mark.parametrize("side", ["l", "r"])
def test_a_cuff_lies_round_the_wrist(side: str):
    """It stood off by 13 mm, and one looked into a dark sleeve."""
    mesh, elbow = load_figure().mesh, CENTRES[f"{side}_elbow"]
    bone = CENTRES[f"{side}_wrist"] - elbow
    along = (mesh.positions - elbow) @ bone / (bone @ bone)
    away = np.linalg.norm(mesh.positions - elbow - along[:, None] * bone, axis=1)
    near = (away < 0.06) & (along > 0.84) & (along < 0.97)
    cloth, skin = (near & (mesh.parts == PARTS.index(part)) for part in ("cloth", "skin"))
    assert 0.001 < away[cloth].mean() - away[skin].mean() < 0.007

from pathlib import Path

import numpy as np
import pytest

from kinesic.face.assets.body import BODY, load_figure
from kinesic.face.assets.clothes import COVERED, below_neckline
from kinesic.face.assets.mesh import PARTS, load_head
from kinesic.face.assets.rig import PLACE
from kinesic.face.display import DisplayError

FIGURE = load_figure()
CLOTH = FIGURE.mesh.vertices("cloth")
SKIN = FIGURE.mesh.vertices("skin")


def test_it_is_small():
    assert BODY.stat().st_size < 150_000


def test_weights_add_up():
    np.testing.assert_allclose(FIGURE.weights.sum(axis=1), 1.0, atol=1e-9)
    assert np.diff(FIGURE.weights.indptr).max() <= 8


def test_the_head_is_the_one_that_is_drawn_alone():
    head = load_head("female")
    where = {point.tobytes() for point in FIGURE.mesh.positions}
    kept = np.array([point.tobytes() in where for point in head.positions])
    bare = below_neckline(head.positions, FIGURE.centres) > 0.0
    assert kept[bare].all()
    assert set(FIGURE.mesh.shapes) == set(head.shapes)
    assert FIGURE.mesh.deltas.nnz >= 0.95 * head.deltas.nnz


def test_no_skin_is_under_the_clothes():
    """Below the neckline there are the hands, and nothing of the trunk, the arms or the legs."""
    moved = np.asarray(FIGURE.weights[SKIN].argmax(axis=1)).ravel()
    hands = {place for name, place in PLACE.items() if name[2:].startswith(("elbow", "wrist", "thumb", "index", "mid"))}
    hands |= {place for name, place in PLACE.items() if name[2:].startswith(("ring", "pinky"))}
    deep = below_neckline(FIGURE.mesh.positions[SKIN], FIGURE.centres) < -COVERED - 0.03
    assert deep.any()
    assert set(moved[deep]) <= hands


def test_three_garments_are_cut_by_their_borders():
    looks = np.unique(FIGURE.mesh.plain[CLOTH], axis=0)
    assert len(looks) == 3
    beyond = FIGURE.mesh.tips[CLOTH]
    assert beyond.min() < -0.1
    corners = FIGURE.mesh.tips[FIGURE.mesh.faces]
    cloth = FIGURE.mesh.parts[FIGURE.mesh.faces[:, 0]] == PARTS.index("cloth")
    assert (corners[cloth].min(axis=1) < 0.0).all()  # no face is cut away as a whole


def test_left_mirrors_right():
    assert abs(FIGURE.mesh.positions[CLOTH, 1].mean()) < 1e-3
    np.testing.assert_allclose(FIGURE.centres["l_elbow"] * (1, -1, 1), FIGURE.centres["r_elbow"], atol=2e-4)


def test_a_finer_figure_is_moved_alike():
    finer = FIGURE.subdivided()
    assert len(finer.mesh.faces) == 4 * len(FIGURE.mesh.faces)
    np.testing.assert_allclose(finer.weights.sum(axis=1), 1.0, atol=1e-9)


@pytest.mark.parametrize(("content", "message"), [(None, "install kinesic again"), (b"no", "not a body that kinesic")])
def test_a_wrong_file_teaches(tmp_path: Path, content: bytes | None, message: str):
    path = tmp_path / "body.npz"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(DisplayError, match=message):
        load_figure(path)

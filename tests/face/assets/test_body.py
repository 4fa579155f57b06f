from pathlib import Path

import numpy as np
import pytest

from kinesic.face.assets.body import BODY_FILE, load_figure
from kinesic.face.assets.clothes import COVERED_DEPTH, measure_neckline_distance
from kinesic.face.assets.mesh import MESH_PARTS, load_head
from kinesic.face.assets.rig import FRAME_INDICES
from kinesic.face.display import DisplayError

DRESSED_FIGURE = load_figure()
CLOTH_VERTICES = DRESSED_FIGURE.mesh.vertices("cloth")
SKIN_VERTICES = DRESSED_FIGURE.mesh.vertices("skin")


def test_body_file_is_smaller_than_150_kilobytes():
    assert BODY_FILE.stat().st_size < 150_000


def test_skinning_weights_sum_to_one():
    np.testing.assert_allclose(DRESSED_FIGURE.weights.sum(axis=1), 1.0, atol=1e-9)
    assert np.diff(DRESSED_FIGURE.weights.indptr).max() <= 8


def test_figure_contains_the_head_mesh_vertices_above_the_neckline():
    head = load_head("female")
    where = {point.tobytes() for point in DRESSED_FIGURE.mesh.positions}
    remaining = np.array([point.tobytes() in where for point in head.positions])
    bare = measure_neckline_distance(head.positions, DRESSED_FIGURE.centres) > 0.0
    assert remaining[bare].all()
    assert set(DRESSED_FIGURE.mesh.shapes) == set(head.shapes)
    assert DRESSED_FIGURE.mesh.deltas.nnz >= 0.95 * head.deltas.nnz


def test_figure_has_only_hand_skin_far_below_the_neckline():
    """Expect only the skin of the hands below the clothes' neckline."""
    moved = np.asarray(DRESSED_FIGURE.weights[SKIN_VERTICES].argmax(axis=1)).ravel()
    hands = {
        place
        for name, place in FRAME_INDICES.items()
        if name[2:].startswith(("elbow", "wrist", "thumb", "index", "mid"))
    }
    hands |= {place for name, place in FRAME_INDICES.items() if name[2:].startswith(("ring", "pinky"))}
    deep = (
        measure_neckline_distance(DRESSED_FIGURE.mesh.positions[SKIN_VERTICES], DRESSED_FIGURE.centres)
        < -COVERED_DEPTH - 0.03
    )
    assert deep.any()
    assert set(moved[deep]) <= hands


def test_figure_has_three_garments_that_extend_beyond_their_cut_borders():
    looks = np.unique(DRESSED_FIGURE.mesh.plain[CLOTH_VERTICES], axis=0)
    assert len(looks) == 3
    beyond = DRESSED_FIGURE.mesh.tips[CLOTH_VERTICES]
    assert beyond.min() < -0.1
    corners = DRESSED_FIGURE.mesh.tips[DRESSED_FIGURE.mesh.faces]
    cloth = DRESSED_FIGURE.mesh.parts[DRESSED_FIGURE.mesh.faces[:, 0]] == MESH_PARTS.index("cloth")
    assert (corners[cloth].min(axis=1) < 0.0).all()  # no face is removed completely


def test_clothes_are_centred_and_elbows_are_mirrored_left_to_right():
    assert abs(DRESSED_FIGURE.mesh.positions[CLOTH_VERTICES, 1].mean()) < 1e-3
    np.testing.assert_allclose(
        DRESSED_FIGURE.centres["l_elbow"] * (1, -1, 1), DRESSED_FIGURE.centres["r_elbow"], atol=2e-4
    )


def test_subdivided_figure_has_four_times_the_faces_and_normalised_weights():
    finer = DRESSED_FIGURE.subdivided()
    assert len(finer.mesh.faces) == 4 * len(DRESSED_FIGURE.mesh.faces)
    np.testing.assert_allclose(finer.weights.sum(axis=1), 1.0, atol=1e-9)


@pytest.mark.parametrize(("content", "message"), [(None, "install kinesic again"), (b"no", "not a body that kinesic")])
def test_missing_or_invalid_body_file_is_rejected(tmp_path: Path, content: bytes | None, message: str):
    path = tmp_path / "body.npz"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(DisplayError, match=message):
        load_figure(path)

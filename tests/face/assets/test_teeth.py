import numpy as np
import pytest

from kinesic.face.assets.mesh import FACE_VARIANTS, Mesh, load_head
from kinesic.face.assets.teeth import compute_teeth_chart


@pytest.fixture(scope="module", params=[*FACE_VARIANTS, "finer"])
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return load_head().subdivided() if request.param == "finer" else load_head(request.param)


def test_tooth_coordinates_run_along_the_row_and_towards_the_gums(mesh: Mesh):
    place, points = compute_teeth_chart(mesh), mesh.positions[mesh.vertices("teeth")]
    for jaw in (1.0, -1.0):
        along, away = place[place[:, 3] == jaw, :2].T
        row = points[place[:, 3] == jaw]
        front = np.abs(along) < 22.0
        nearest = front & (np.abs(away) < 12.0) & (np.abs(row[:, 1]) < 0.008)
        np.testing.assert_allclose(along[nearest], 1000.0 * row[nearest, 1], atol=3.0)  # a row is straight in front
        assert 45.0 < along.max() < 70.0
        np.testing.assert_allclose(along.min(), -along.max(), rtol=0.02)
        edge, gums = row[front & (np.abs(away) < 0.5)], row[front & (away > 10.0)]
        assert len(edge) >= 4
        assert np.all(jaw * (gums[:, 2].mean() - edge[:, 2]) > 0.008)
        assert row[front & (away < -2.0), 0].max() < edge[:, 0].max() - 0.003  # the side of the tongue


def test_upper_teeth_are_in_front_of_lower_teeth(mesh: Mesh):
    place, points = compute_teeth_chart(mesh), mesh.positions[mesh.vertices("teeth")]
    upper, lower = (
        points[(place[:, 3] == jaw) & (np.abs(place[:, 0]) < 6.0) & (np.abs(place[:, 1]) < 0.5)] for jaw in (1.0, -1.0)
    )
    assert 0.0 < lower[:, 2].max() - upper[:, 2].min() < 0.005
    assert upper[:, 0].min() > lower[:, 0].max() + 0.001

import math

import numpy as np
import pytest

from kinesic.body.action_units import ACTION_UNITS, FACE_CHANNELS, MAX_EYE_DEPRESSION, MAX_EYE_ELEVATION, MAX_EYE_YAW
from kinesic.face.assets.action_units import compute_shape_weights, deform, read_intensities
from kinesic.face.assets.lips import find_lips
from kinesic.face.assets.mesh import FACE_VARIANTS, MESH_PARTS, Mesh, load_head
from kinesic.face.display import DisplayError

MOUTH_WINDOW = (-0.03, 0.03, -0.115, -0.045)  # [m] right, left, lower and upper border of the region around the mouth
EYE_WINDOW = (-0.05, 0.05, -0.012, 0.012)


@pytest.fixture(scope="module", params=FACE_VARIANTS)
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return load_head(request.param)


def seen(mesh: Mesh, positions: np.ndarray, window: tuple[float, float, float, float], steps: int = 36) -> set[str]:
    """Return the head parts that frontal rays hit inside a window."""
    right, left, low, high = window
    corners = positions[mesh.triangles]
    near = (corners[:, :, 1].max(axis=1) > right) & (corners[:, :, 1].min(axis=1) < left)
    near &= (corners[:, :, 2].max(axis=1) > low) & (corners[:, :, 2].min(axis=1) < high) & (corners[:, 0, 0] > -0.03)
    a, b, c = corners[near].transpose(1, 0, 2)
    part = mesh.parts[mesh.triangles[near][:, 0]]
    area = (b[:, 1] - a[:, 1]) * (c[:, 2] - a[:, 2]) - (b[:, 2] - a[:, 2]) * (c[:, 1] - a[:, 1])
    area = np.where(np.abs(area) < 1e-15, np.nan, area)  # triangles seen edge-on hide nothing
    least, most = corners[near][:, :, 1].min(axis=1), corners[near][:, :, 1].max(axis=1)
    z, actual = np.linspace(low, high, steps)[:, None], set()
    for y in np.linspace(right, left, steps):
        # no other triangle is hit in this column
        here = np.flatnonzero(np.abs(y - (least + most) / 2) <= (most - least) / 2 + 1e-9)
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = a[here].T, b[here].T, c[here].T
        v = ((y - ay) * (cz - az) - (z - az) * (cy - ay)) / area[here]
        w = ((by - ay) * (z - az) - (bz - az) * (y - ay)) / area[here]
        hit = (v >= 0) & (w >= 0) & (v + w <= 1)
        depth = np.where(hit, ax + v * (bx - ax) + w * (cx - ax), -np.inf)[hit.any(axis=1)]
        actual |= {MESH_PARTS[item] for item in part[here[depth.argmax(axis=1)]]} if len(depth) else set()
    return actual


def moved(mesh: Mesh, **units: float) -> np.ndarray:
    return deform(mesh, {name.lstrip("_"): value for name, value in units.items()}) - mesh.positions


def centre(mesh: Mesh, y: float, z: float) -> np.intp:
    """Return the front skin vertex that is nearest to a place."""
    skin = np.flatnonzero((mesh.parts == 0) & (mesh.positions[:, 0] > 0.0))
    return skin[np.argmin(np.hypot(mesh.positions[skin, 1] - y, mesh.positions[skin, 2] - z))]


def test_neutral_face_differs_from_the_source_mesh_only_at_the_lips(mesh: Mesh):
    rest = deform(mesh, {})
    assert np.array_equal(deform(mesh, {"12": 0.0, "L45": 0.0}), rest)
    apart = np.setdiff1d(np.arange(len(rest)), find_lips(mesh).skin)
    assert np.array_equal(rest[apart], mesh.positions[apart])
    assert np.abs(rest - mesh.positions).max() < 0.0005


def test_each_action_unit_keeps_the_back_of_the_head_still_and_moves_mainly_one_side(mesh: Mesh):
    back = mesh.positions[:, 0] < -0.08
    for channel in FACE_CHANNELS:
        change = np.linalg.norm(deform(mesh, {channel: 1.0}) - mesh.positions, axis=1)
        assert 1e-3 < change.max() < 0.05, channel
        assert change[back].max() < 1e-3, channel
        if channel[0] in "LR" and channel[1:] != "30":  # the jaw moves sideways as a whole
            other = mesh.positions[:, 1] < -0.02 if channel[0] == "L" else mesh.positions[:, 1] > 0.02
            assert change[other].max() < 0.35 * change.max(), channel


def test_left_and_right_action_units_move_the_face_by_equal_distances(mesh: Mesh):
    for number in (number for number, unit in ACTION_UNITS.items() if unit.sided and number != 30):
        left = np.linalg.norm(moved(mesh, **{f"L{number}": 1.0}), axis=1)
        right = np.linalg.norm(moved(mesh, **{f"R{number}": 1.0}), axis=1)
        assert left.max() == pytest.approx(right.max(), rel=0.05), number
        both = moved(mesh, **{f"_{number}": 1.0})
        np.testing.assert_allclose(np.linalg.norm(both, axis=1).max(), left.max(), rtol=0.3, err_msg=str(number))


def test_brow_lip_corner_and_jaw_units_move_the_face_up_or_down(mesh: Mesh):
    apart = mesh.eyes[0, 1]
    inner, outer = centre(mesh, 0.4 * apart, 0.02), centre(mesh, 1.5 * apart, 0.022)
    assert moved(mesh, L1=1.0)[inner, 2] > 1e-3
    assert moved(mesh, L2=1.0)[outer, 2] > 1e-3
    assert moved(mesh, L4=1.0)[inner, 2] < -1e-3
    corner = np.argmax(np.linalg.norm(moved(mesh, L12=1.0), axis=1))
    assert mesh.positions[corner, 1] > 0.01
    assert moved(mesh, L12=1.0)[corner, 2] > 3e-3
    chin = centre(mesh, 0.0, -0.11)
    assert moved(mesh, _26=1.0)[chin, 2] < -5e-3
    assert moved(mesh, _27=1.0)[chin, 2] < 1.5 * moved(mesh, _26=1.0)[chin, 2]


def test_lip_stretcher_unit_pulls_the_lip_corner_outward_and_not_downward(mesh: Mesh):
    still = mesh.positions
    lip = np.flatnonzero(
        (mesh.parts == 0) & (np.abs(still[:, 2] - still[mesh.vertices("teeth"), 2].max() + 0.014) < 0.01)
    )
    lip = lip[(still[lip, 0] > 0.01) & (np.abs(still[lip, 1] - 0.022) < 0.004)]
    corner = lip[np.argmax(moved(mesh, L20=1.0)[lip, 1])]
    _, aside, up = moved(mesh, L20=1.0)[corner]
    assert aside > 6e-3
    assert abs(up) < 0.3 * aside


def test_brow_height_grows_with_action_unit_intensity(mesh: Mesh):
    apart = mesh.eyes[0, 1]
    for y in (0.4 * apart, 1.1 * apart):
        brow = centre(mesh, y, 0.021)
        low, high = (moved(mesh, _1=fraction, _2=fraction)[brow, 2] for fraction in (0.4, 1.0))
        assert high > 5e-3
        assert high - low > 3e-3


def test_cheek_raiser_unit_moves_the_cheek_up_and_outward(mesh: Mesh):
    apart = mesh.eyes[0, 1]
    cheek = centre(mesh, 1.15 * apart, -0.8 * apart)
    forward, aside, up = moved(mesh, L6=1.0)[cheek]
    assert up > 3e-3
    assert np.dot(mesh.normals(mesh.positions)[cheek], (forward, aside, up)) > 1e-3


def test_pressed_lips_stay_closed_at_three_jaw_openings(mesh: Mesh):
    assert seen(mesh, mesh.positions, MOUTH_WINDOW) == {"skin"}
    assert seen(mesh, deform(mesh, {"26": 1.0, "25": 1.0}), MOUTH_WINDOW) >= {"skin", "tongue"}
    for jaw in (0.0, 0.3, 1.0):
        pressed = deform(mesh, {"24": 1.0, "25": 1.0, "26": jaw})
        assert seen(mesh, pressed, MOUTH_WINDOW) == {"skin"}, jaw


def test_broad_smile_with_parted_lips_shows_teeth(mesh: Mesh):
    assert "teeth" in seen(mesh, deform(mesh, {"12": 1.0, "25": 0.9, "26": 0.5}), MOUTH_WINDOW)


@pytest.mark.parametrize("also", [{}, {"64": 1.0}, {"63": 1.0}, {"5": 1.0}, {"7": 1.0, "61": 1.0}])
def test_closed_lids_hide_the_eyes_with_gaze_and_other_lid_units(mesh: Mesh, also: dict[str, float]):
    assert "eyes" in seen(mesh, mesh.positions, EYE_WINDOW)
    for closing in ("43", "45"):
        assert "eyes" not in seen(mesh, deform(mesh, {closing: 1.0, **also}), EYE_WINDOW)


def test_wink_of_the_right_eye_hides_the_right_eyeball_and_not_the_left(mesh: Mesh):
    winked = deform(mesh, {"R46": 1.0})
    assert "eyes" in seen(mesh, winked, (0.0, 0.05, -0.012, 0.012))
    assert "eyes" not in seen(mesh, winked, (-0.05, 0.0, -0.012, 0.012))


@pytest.mark.parametrize(
    ("units", "direction"),
    [
        ({"61": 1.0}, (math.cos(MAX_EYE_YAW), math.sin(MAX_EYE_YAW), 0.0)),
        ({"62": 0.5}, (math.cos(MAX_EYE_YAW / 2), -math.sin(MAX_EYE_YAW / 2), 0.0)),
        ({"63": 1.0}, (math.cos(MAX_EYE_ELEVATION), 0.0, math.sin(MAX_EYE_ELEVATION))),
        ({"64": 1.0}, (math.cos(MAX_EYE_DEPRESSION), 0.0, -math.sin(MAX_EYE_DEPRESSION))),
    ],
)
def test_gaze_action_units_rotate_the_eyeballs_about_their_centres(
    mesh: Mesh, units: dict[str, float], direction: tuple[float, ...]
):
    positions = deform(mesh, units)
    eyes = mesh.vertices("eyes")
    is_left = mesh.positions[eyes, 1] > 0
    for eyeball, middle in zip((eyes[is_left], eyes[~is_left]), mesh.eyes, strict=True):
        previous, after = mesh.positions[eyeball] - middle, positions[eyeball] - middle
        np.testing.assert_allclose(np.linalg.norm(after, axis=1), np.linalg.norm(previous, axis=1))
        pupil = np.argmax(previous[:, 0])
        rotated = after[pupil] - previous[pupil]
        assert np.dot(rotated, np.array(direction) - (1.0, 0.0, 0.0)) > 0.0
        ahead = np.linalg.lstsq(previous, after, rcond=None)[0].T @ (1.0, 0.0, 0.0)
        np.testing.assert_allclose(ahead, direction, atol=1e-6)


def test_subdivided_head_deforms_like_the_coarse_head_within_4_mm():
    mesh = load_head("female")
    fine = mesh.subdivided()
    units = {"12": 0.8, "26": 0.5, "61": 0.7, "L43": 0.4}
    coarse, smooth = deform(mesh, units) - mesh.positions, deform(fine, units) - fine.positions
    away = np.linalg.norm(smooth[: len(coarse)] - coarse, axis=1)
    assert np.median(away) < 1e-4
    assert away.max() < 4e-3


def test_action_unit_without_side_moves_both_sides_and_the_larger_value_counts():
    assert np.array_equal(read_intensities({"12": 0.5}), read_intensities({"L12": 0.5, "R12": 0.5}))
    given_values = read_intensities({"L12": 0.9, "12": 0.4})
    assert given_values[FACE_CHANNELS.index("L12")] == 0.9
    assert given_values[FACE_CHANNELS.index("R12")] == 0.4


def test_face_blend_shape_weights_stay_in_0_to_1():
    mesh = load_head()
    actual = compute_shape_weights(mesh, dict.fromkeys(FACE_CHANNELS, 1.0))
    assert actual.min() >= 0.0
    assert actual.max() <= 1.0


@pytest.mark.parametrize("name", ["3", "AU12", "L26", "", "jaw", "121"])
def test_unknown_action_unit_is_rejected(name: str):
    with pytest.raises(DisplayError, match=f"no action unit {name}(; known: 1, 2|: jaw drop has no sides; write 26)"):
        deform(load_head(), {name: 0.5})


@pytest.mark.parametrize("value", [1.5, -0.1, math.nan, math.inf])
def test_action_unit_intensity_outside_0_to_1_is_rejected(value: float):
    with pytest.raises(DisplayError, match=r"action unit 12 is .*; intensities go from 0 to 1"):
        deform(load_head(), {"12": value})


def mouth_size(mesh: Mesh, positions: np.ndarray) -> tuple[float, float]:
    """Return width of the mouth and visible height of the red lips [m]."""
    rest, unit = mesh.positions, float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
    corner = [np.linalg.norm(rest - unit * np.array([0.62, aside, -1.09]), axis=1).argmin() for aside in (0.40, -0.40)]
    middle = (mesh.parts == MESH_PARTS.index("skin")) & (np.abs(rest[:, 1]) < 0.06 * unit) & (rest[:, 0] > 0.5 * unit)
    red = middle & (rest[:, 2] < -0.95 * unit) & (rest[:, 2] > -1.30 * unit)
    return float(np.ptp(positions[corner, 1])), float(np.ptp(positions[red, 2]))


def test_tightened_pressed_and_sucked_lips_differ_in_shape(mesh: Mesh):
    rest = mouth_size(mesh, deform(mesh, {}))
    tight, pressed, sucked = (mouth_size(mesh, deform(mesh, {unit: 1.0})) for unit in ("23", "24", "28"))
    assert tight[0] < rest[0] - 0.004
    assert pressed[0] > rest[0] + 0.002
    assert tight[1] < 0.9 * rest[1]
    assert pressed[1] < 0.9 * rest[1]
    assert sucked[1] < 0.85 * pressed[1]


def test_combined_pucker_and_funnel_of_the_lips_stays_bounded(mesh: Mesh):
    middle = centre(mesh, 0.0, -0.95)
    units = {"18": 1.0, "22": 1.0, "25": 1.0}
    raised = deform(mesh, units)[middle] - deform(mesh, {})[middle]
    assert abs(raised[2]) < 0.008
    assert raised[0] > -0.001
    weights = compute_shape_weights(mesh, units)
    assert weights[mesh.shapes.index("mouthPucker")] + weights[mesh.shapes.index("mouthFunnel")] < 1.35

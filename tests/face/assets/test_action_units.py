import math

import numpy as np
import pytest

from kinesic.body.action_units import ASIDE, CHANNELS, DOWNWARD, UNITS, UPWARD
from kinesic.face.assets.action_units import deform, intensities, shape_weights
from kinesic.face.assets.lips import lips
from kinesic.face.assets.mesh import PARTS, VARIANTS, Mesh, load_head
from kinesic.face.display import DisplayError

MOUTH = (-0.03, 0.03, -0.115, -0.045)  # [m] right, left, low, high
EYES = (-0.05, 0.05, -0.012, 0.012)


@pytest.fixture(scope="module", params=VARIANTS)
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return load_head(request.param)


def seen(mesh: Mesh, positions: np.ndarray, window: tuple[float, float, float, float], steps: int = 36) -> set[str]:
    """Parts that show in a window, seen from in front along parallel rays."""
    right, left, low, high = window
    corners = positions[mesh.triangles]
    near = (corners[:, :, 1].max(axis=1) > right) & (corners[:, :, 1].min(axis=1) < left)
    near &= (corners[:, :, 2].max(axis=1) > low) & (corners[:, :, 2].min(axis=1) < high) & (corners[:, 0, 0] > -0.03)
    a, b, c = corners[near].transpose(1, 0, 2)
    part = mesh.parts[mesh.triangles[near][:, 0]]
    area = (b[:, 1] - a[:, 1]) * (c[:, 2] - a[:, 2]) - (b[:, 2] - a[:, 2]) * (c[:, 1] - a[:, 1])
    area = np.where(np.abs(area) < 1e-15, np.nan, area)  # edge-on it hides nothing
    least, most = corners[near][:, :, 1].min(axis=1), corners[near][:, :, 1].max(axis=1)
    z, found = np.linspace(low, high, steps)[:, None], set()
    for y in np.linspace(right, left, steps):
        # no other triangle is hit in this column
        here = np.flatnonzero(np.abs(y - (least + most) / 2) <= (most - least) / 2 + 1e-9)
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = a[here].T, b[here].T, c[here].T
        v = ((y - ay) * (cz - az) - (z - az) * (cy - ay)) / area[here]
        w = ((by - ay) * (z - az) - (bz - az) * (y - ay)) / area[here]
        hit = (v >= 0) & (w >= 0) & (v + w <= 1)
        depth = np.where(hit, ax + v * (bx - ax) + w * (cx - ax), -np.inf)[hit.any(axis=1)]
        found |= {PARTS[each] for each in part[here[depth.argmax(axis=1)]]} if len(depth) else set()
    return found


def moved(mesh: Mesh, **units: float) -> np.ndarray:
    return deform(mesh, {name.lstrip("_"): value for name, value in units.items()}) - mesh.positions


def centre(mesh: Mesh, y: float, z: float) -> np.intp:
    """The vertex of the skin in front that is nearest to a place."""
    skin = np.flatnonzero((mesh.parts == 0) & (mesh.positions[:, 0] > 0.0))
    return skin[np.argmin(np.hypot(mesh.positions[skin, 1] - y, mesh.positions[skin, 2] - z))]


def test_nothing_is_the_face_at_rest_to_the_last_bit_but_for_lips_that_touch(mesh: Mesh):
    rest = deform(mesh, {})
    assert np.array_equal(deform(mesh, {"12": 0.0, "L45": 0.0}), rest)
    apart = np.setdiff1d(np.arange(len(rest)), lips(mesh).skin)
    assert np.array_equal(rest[apart], mesh.positions[apart])
    assert np.abs(rest - mesh.positions).max() < 0.0005


def test_every_unit_moves_something_and_stays_in_its_place(mesh: Mesh):
    back = mesh.positions[:, 0] < -0.08
    for channel in CHANNELS:
        change = np.linalg.norm(deform(mesh, {channel: 1.0}) - mesh.positions, axis=1)
        assert 1e-3 < change.max() < 0.05, channel
        assert change[back].max() < 1e-3, channel
        if channel[0] in "LR" and channel[1:] != "30":  # the jaw goes aside as a whole
            other = mesh.positions[:, 1] < -0.02 if channel[0] == "L" else mesh.positions[:, 1] > 0.02
            assert change[other].max() < 0.35 * change.max(), channel


def test_left_and_right_are_alike(mesh: Mesh):
    for number in (number for number, unit in UNITS.items() if unit.sided and number != 30):
        left = np.linalg.norm(moved(mesh, **{f"L{number}": 1.0}), axis=1)
        right = np.linalg.norm(moved(mesh, **{f"R{number}": 1.0}), axis=1)
        assert left.max() == pytest.approx(right.max(), rel=0.05), number
        both = moved(mesh, **{f"_{number}": 1.0})
        np.testing.assert_allclose(np.linalg.norm(both, axis=1).max(), left.max(), rtol=0.3, err_msg=str(number))


def test_muscles_pull_where_anatomy_says(mesh: Mesh):
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


def test_lips_are_stretched_outward_not_downward(mesh: Mesh):
    still = mesh.positions
    lip = np.flatnonzero(
        (mesh.parts == 0) & (np.abs(still[:, 2] - still[mesh.vertices("teeth"), 2].max() + 0.014) < 0.01)
    )
    lip = lip[(still[lip, 0] > 0.01) & (np.abs(still[lip, 1] - 0.022) < 0.004)]
    corner = lip[np.argmax(moved(mesh, L20=1.0)[lip, 1])]
    _, aside, up = moved(mesh, L20=1.0)[corner]
    assert aside > 6e-3
    assert abs(up) < 0.3 * aside


def test_brows_go_much_further_up_at_full_than_at_low_intensity(mesh: Mesh):
    apart = mesh.eyes[0, 1]
    for y in (0.4 * apart, 1.1 * apart):
        brow = centre(mesh, y, 0.021)
        low, high = (moved(mesh, _1=share, _2=share)[brow, 2] for share in (0.4, 1.0))
        assert high > 5e-3
        assert high - low > 3e-3


def test_a_raised_cheek_goes_up_and_stands_out(mesh: Mesh):
    apart = mesh.eyes[0, 1]
    cheek = centre(mesh, 1.15 * apart, -0.8 * apart)
    forward, aside, up = moved(mesh, L6=1.0)[cheek]
    assert up > 3e-3
    assert np.dot(mesh.normals(mesh.positions)[cheek], (forward, aside, up)) > 1e-3


def test_pressed_lips_stay_closed_whatever_the_jaw_does(mesh: Mesh):
    assert seen(mesh, mesh.positions, MOUTH) == {"skin"}
    assert seen(mesh, deform(mesh, {"26": 1.0, "25": 1.0}), MOUTH) >= {"skin", "tongue"}
    for jaw in (0.0, 0.3, 1.0):
        pressed = deform(mesh, {"24": 1.0, "25": 1.0, "26": jaw})
        assert seen(mesh, pressed, MOUTH) == {"skin"}, jaw


def test_a_broad_smile_with_parted_lips_shows_teeth(mesh: Mesh):
    assert "teeth" in seen(mesh, deform(mesh, {"12": 1.0, "25": 0.9, "26": 0.5}), MOUTH)


@pytest.mark.parametrize("also", [{}, {"64": 1.0}, {"63": 1.0}, {"5": 1.0}, {"7": 1.0, "61": 1.0}])
def test_closed_lids_hide_the_eyes_wherever_they_look(mesh: Mesh, also: dict[str, float]):
    assert "eyes" in seen(mesh, mesh.positions, EYES)
    for closing in ("43", "45"):
        assert "eyes" not in seen(mesh, deform(mesh, {closing: 1.0, **also}), EYES)


def test_a_wink_closes_one_eye(mesh: Mesh):
    winked = deform(mesh, {"R46": 1.0})
    assert "eyes" in seen(mesh, winked, (0.0, 0.05, -0.012, 0.012))
    assert "eyes" not in seen(mesh, winked, (-0.05, 0.0, -0.012, 0.012))


@pytest.mark.parametrize(
    ("units", "direction"),
    [
        ({"61": 1.0}, (math.cos(ASIDE), math.sin(ASIDE), 0.0)),
        ({"62": 0.5}, (math.cos(ASIDE / 2), -math.sin(ASIDE / 2), 0.0)),
        ({"63": 1.0}, (math.cos(UPWARD), 0.0, math.sin(UPWARD))),
        ({"64": 1.0}, (math.cos(DOWNWARD), 0.0, -math.sin(DOWNWARD))),
    ],
)
def test_eyeballs_turn_about_their_centres(mesh: Mesh, units: dict[str, float], direction: tuple[float, ...]):
    positions = deform(mesh, units)
    eyes = mesh.vertices("eyes")
    is_left = mesh.positions[eyes, 1] > 0
    for eyeball, middle in zip((eyes[is_left], eyes[~is_left]), mesh.eyes, strict=True):
        before, after = mesh.positions[eyeball] - middle, positions[eyeball] - middle
        np.testing.assert_allclose(np.linalg.norm(after, axis=1), np.linalg.norm(before, axis=1))
        pupil = np.argmax(before[:, 0])
        turned = after[pupil] - before[pupil]
        assert np.dot(turned, np.array(direction) - (1.0, 0.0, 0.0)) > 0.0
        ahead = np.linalg.lstsq(before, after, rcond=None)[0].T @ (1.0, 0.0, 0.0)
        np.testing.assert_allclose(ahead, direction, atol=1e-6)


def test_the_finer_head_does_the_same():
    mesh = load_head("female")
    fine = mesh.subdivided()
    units = {"12": 0.8, "26": 0.5, "61": 0.7, "L43": 0.4}
    coarse, smooth = deform(mesh, units) - mesh.positions, deform(fine, units) - fine.positions
    away = np.linalg.norm(smooth[: len(coarse)] - coarse, axis=1)
    assert np.median(away) < 1e-4
    assert away.max() < 4e-3


def test_a_number_means_both_sides_and_the_stronger_counts():
    assert np.array_equal(intensities({"12": 0.5}), intensities({"L12": 0.5, "R12": 0.5}))
    told = intensities({"L12": 0.9, "12": 0.4})
    assert told[CHANNELS.index("L12")] == 0.9
    assert told[CHANNELS.index("R12")] == 0.4


def test_weights_stay_inside_0_and_1():
    mesh = load_head()
    found = shape_weights(mesh, dict.fromkeys(CHANNELS, 1.0))
    assert found.min() >= 0.0
    assert found.max() <= 1.0


@pytest.mark.parametrize("name", ["3", "AU12", "L26", "", "jaw", "121"])
def test_an_unknown_unit_is_refused(name: str):
    with pytest.raises(DisplayError, match=f"no action unit {name}(; known: 1, 2|: jaw drop has no sides; write 26)"):
        deform(load_head(), {name: 0.5})


@pytest.mark.parametrize("value", [1.5, -0.1, math.nan, math.inf])
def test_an_intensity_outside_0_and_1_is_refused(value: float):
    with pytest.raises(DisplayError, match=r"action unit 12 is .*; intensities go from 0 to 1"):
        deform(load_head(), {"12": value})

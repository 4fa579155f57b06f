"""Tests of wrinkle maps and of the normals that they bend."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from kinesic.body.arrays import Floats
from kinesic.face.assets.action_units import read_intensities
from kinesic.face.assets.chart import compute_chart_window
from kinesic.face.render import wrinkles as wrinkle_maps
from kinesic.face.render.camera import FRONT_CAMERA, Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET
from kinesic.face.render.wrinkles import (
    MAP_COUNT,
    compute_map_strengths,
    draw_wrinkle_maps,
    interpolate_line,
    load_wrinkles,
)

from ..conftest import Gallery

TABLE_41 = {1: (0,), 2: (1, 2), 4: (3,), 6: (4, 5), 10: (6, 7), 12: (8, 9), 20: (10, 11)}  # action unit -> wrinkle maps
ADDED_UNITS = {9: (12,), 15: (13,), 17: (14,), 14: (15,)}  # action unit -> wrinkle maps, for units missing in the table
WRINKLED_UNITS = sorted(TABLE_41 | ADDED_UNITS)
PICTURE_SIDE = 160  # [pixels] side of the pictures
CAMERA_YAWS = (0.0, 30.0, 90.0, -90.0, 140.0, 180.0)
BACK_POSITION = -0.6  # [distances between the eyes] the wrinkles end in front of this


class Bent:
    """Normals of a motionless head, on which only wrinkles act."""

    def __init__(self, portrait: Portrait) -> None:
        self.pipeline = portrait.pipeline

    def normals(self, units: dict[str, float], camera: Camera = FRONT_CAMERA, gain: float = 1.0) -> Floats:
        """Return the (height, width, 3) normals with the shape at rest."""
        with self.context():
            self.pipeline.geometry.draw({}, camera)
            _, actual = self.pipeline.relief.draw(compute_map_strengths(read_intensities(units)) * gain)
            width, height = actual.size
            pixels = np.frombuffer(actual.read(), "f4").reshape(height, width, 4)[::-1, :, :3].astype(np.float64)
            return pixels * self.covered(camera)[..., None]

    def covered(self, camera: Camera) -> Floats:
        """Return a (height, width) mask of the head."""
        with self.context():
            self.pipeline.geometry.draw({}, camera)
            return np.sign(self.pipeline.geometry.parts())

    def flat(self, camera: Camera = FRONT_CAMERA) -> Floats:
        """Return the (height, width, 3) normals of the G-buffer."""
        with self.context():
            return self.pipeline.geometry.draw({}, camera).read()[..., :3] * self.covered(camera)[..., None]

    def places(self, camera: Camera = FRONT_CAMERA) -> tuple[Floats, NDArray[np.intp]]:
        """Return the chart positions and the parts of all pixels.

        Shapes are (height, width, 4) and (height, width); part 0 is the background, 1 is skin.
        """
        with self.context():
            buffer = self.pipeline.geometry.draw({}, camera)
            return buffer.read(1), self.pipeline.geometry.parts()

    def context(self):
        return self.pipeline.geometry.context


@pytest.fixture(scope="module")
def bent(gallery: Gallery) -> Iterator[Bent]:
    """Head without locks, which cover the two sides of a forehead differently."""
    with gallery(replace(NORMAL_PRESET, hair=False), (PICTURE_SIDE, PICTURE_SIDE)) as portrait:
        yield Bent(portrait)


def tangent(normals: Floats, flat: Floats) -> Floats:
    """Return the (height, width) tangent of the angle between normals.

    The cosine would lose small angles.
    """
    cosine = (normals * flat).sum(axis=2)
    sine = np.linalg.norm(np.cross(normals, flat), axis=2)
    return np.where(cosine > 0.0, sine / np.maximum(cosine, 1e-3), 0.0)


def test_wrinkle_maps_of_action_units_match_the_published_table():
    assert {wrinkle.unit: wrinkle.maps for wrinkle in load_wrinkles()} == TABLE_41 | ADDED_UNITS
    assert draw_wrinkle_maps().shape[0] == MAP_COUNT
    assert np.all(np.abs(draw_wrinkle_maps()).max(axis=(1, 2)) > 0.2)


def test_furrows_around_the_mouth_are_wider_than_0_027_chart_units_to_either_side():
    """Prevent furrows that look like pencil lines in small pictures."""
    assert min(curve.width for item in load_wrinkles() if item.unit in (15, 17, 20) for curve in item.curves) > 0.027


def test_left_wrinkle_maps_mirror_right_ones():
    for numbers in (TABLE_41 | ADDED_UNITS).values():
        left, right = draw_wrinkle_maps()[numbers[0]], draw_wrinkle_maps()[numbers[-1]]
        np.testing.assert_allclose(left, right[:, ::-1], atol=1e-9)


def test_wrinkle_maps_end_inside_the_chart_window():
    border = np.concatenate(
        [
            draw_wrinkle_maps()[:, 0],
            draw_wrinkle_maps()[:, -1],
            draw_wrinkle_maps()[:, :, 0],
            draw_wrinkle_maps()[:, :, -1],
        ],
        axis=1,
    )
    assert np.all(border == 0.0)


def test_wrinkles_appear_only_on_the_side_of_a_one_sided_action_unit():
    left = compute_map_strengths(read_intensities({"L12": 0.7, "L1": 0.3}))
    assert np.all(left[:, 8] == 0.7)
    assert np.all(left[:, 9] == 0.0)
    assert left[:, 0].tolist() == [0.3, 0.0]
    assert compute_map_strengths(read_intensities({"17": 0.4}))[:, 14].tolist() == [0.4, 0.4]
    assert np.all(compute_map_strengths(read_intensities({"26": 1.0, "16": 1.0})) == 0.0)


def test_furrow_spline_passes_through_its_points():
    points = np.array([[0.0, 0.0], [1.0, 0.5], [2.0, 0.0]])
    line = interpolate_line(points)
    for point in points:
        assert np.linalg.norm(line - point, axis=1).min() < 1e-12


def test_nearest_position_on_a_furrow_line_is_found():
    line, reach = interpolate_line(np.array([[-0.3, -0.2], [0.1, 0.2], [0.4, -0.1], [0.2, -0.3]])), 0.2
    a, y = np.linspace(-0.6, 0.7, 40), np.linspace(-0.5, 0.5, 30)
    away, along = wrinkle_maps._find_nearest(line, reach, a, y)
    fractions = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    dense = np.linspace(0.0, 1.0, 2000)
    points = np.transpose([np.interp(dense, fractions / fractions[-1], item) for item in line.T])
    exact = np.hypot(a[:, None] - points[:, 0], y[:, None, None] - points[:, 1])
    np.testing.assert_allclose(away, np.minimum(exact.min(axis=2), reach), atol=1e-3)
    reached = np.take_along_axis(exact, np.rint(1999 * along).astype(int)[..., None], axis=2)[..., 0]
    np.testing.assert_allclose(reached[away < reach], away[away < reach], atol=1e-3)


@pytest.mark.parametrize("yaw", [0.0, 60.0])
def test_zero_intensity_or_gain_gives_no_wrinkles(bent: Bent, yaw: float):
    camera = Camera(yaw_deg=yaw)
    none = bent.normals({}, camera)
    everything = {str(unit): 1.0 for unit in WRINKLED_UNITS}
    np.testing.assert_array_equal(bent.normals(dict.fromkeys(everything, 0.0), camera), none)
    np.testing.assert_array_equal(bent.normals(everything, camera, gain=0.0), none)
    np.testing.assert_array_equal(none, bent.flat(camera))


@pytest.mark.parametrize("unit", WRINKLED_UNITS)
def test_wrinkle_normal_deviation_is_linear_in_intensity(bent: Bent, unit: int):
    flat = bent.normals({})
    full, half, quarter = (tangent(bent.normals({str(unit): k}), flat) for k in (1.0, 0.5, 0.25))
    deep = (full > 0.05) & (full < 1.5)
    assert deep.sum() > 40
    np.testing.assert_allclose(np.median(half[deep] / full[deep]), 0.5, atol=0.005)
    np.testing.assert_allclose(half[deep], 0.5 * full[deep], rtol=0.02, atol=2e-3)
    np.testing.assert_allclose(quarter[deep], 0.25 * full[deep], rtol=0.02, atol=2e-3)


@pytest.mark.parametrize("unit", WRINKLED_UNITS)
def test_action_unit_changes_skin_normals_only_under_its_wrinkle_maps(bent: Bent, unit: int):
    shown, none = bent.normals({str(unit): 1.0}), bent.normals({})
    deviation = tangent(shown, none)
    place, part = bent.places()
    scale_a, scale_y, offset_a, offset_y = compute_chart_window()
    size = draw_wrinkle_maps().shape[1]
    column = np.clip((place[..., 0] * scale_a + offset_a) * size, 0, size - 1).astype(int)
    row = np.clip((place[..., 1] * scale_y + offset_y) * size, 0, size - 1).astype(int)
    drawn = np.abs(draw_wrinkle_maps()[list((TABLE_41 | ADDED_UNITS)[unit])]).max(axis=0) > 1e-3
    support = binary_dilation(drawn, iterations=8)[row, column]
    energy = deviation**2
    assert energy[support & (part == 1)].sum() >= 0.9999 * energy.sum() > 0.0
    assert (support & (part == 1)).sum() < 0.25 * (part > 0).sum()
    np.testing.assert_array_equal(shown[part > 1], none[part > 1])
    assert np.degrees(np.arctan(deviation.max())) < 65.0


@pytest.mark.parametrize("unit", [unit for unit in WRINKLED_UNITS if unit != 17])  # without sides
def test_left_and_right_wrinkles_are_mirror_images(bent: Bent, unit: int):
    flat = bent.normals({})
    left, right = (tangent(bent.normals({f"{side}{unit}": 1.0}), flat) for side in "LR")
    assert left.max() > 0.1
    difference = np.sqrt(np.mean((left - right[:, ::-1]) ** 2) / np.mean(left**2))
    assert difference < 0.003


@pytest.mark.parametrize("yaw", CAMERA_YAWS)
def test_back_of_the_head_has_no_wrinkles(bent: Bent, yaw: float):
    camera = Camera(yaw_deg=yaw)
    everything = {str(unit): 1.0 for unit in WRINKLED_UNITS}
    changed = np.any(bent.normals(everything, camera) != bent.normals({}, camera), axis=2)
    geometry, view, mesh = bent.pipeline.geometry, camera.view(), bent.pipeline.geometry.mesh
    with bent.context():
        geometry.draw({}, camera)
        seen, positions = geometry.parts() > 0, geometry.positions()
    in_head = (positions - view[:3, 3]) @ view[:3, :3]
    behind = seen & (in_head[..., 0] / (mesh.eyes[0, 1] - mesh.eyes[1, 1]) < BACK_POSITION - 0.05)
    assert behind.sum() > 500 or abs(yaw) < 45
    assert not changed[behind].any()
    if yaw == 180.0:
        assert not changed.any()


@pytest.mark.parametrize("yaw", CAMERA_YAWS)
def test_wrinkle_normals_are_equal_if_drawn_on_the_whole_picture_or_the_face_only(
    bent: Bent, yaw: float, monkeypatch: pytest.MonkeyPatch
):
    camera, everything = Camera(yaw_deg=yaw), {str(unit): 1.0 for unit in WRINKLED_UNITS}
    actual = bent.normals(everything, camera)
    geometry = bent.pipeline.geometry
    monkeypatch.setattr(geometry, "rectangle", lambda _: (0, 0, *geometry.size))
    np.testing.assert_allclose(actual, bent.normals(everything, camera), atol=1e-4)


def test_wrinkles_are_independent_of_camera_distance(bent: Bent):
    """Compare furrow slopes at twice the distance and half the field."""
    near = Camera()
    far = Camera(distance=2 * near.distance, field_deg=near.field_deg / 2)
    steep = [
        np.degrees(np.arctan(tangent(bent.normals({"4": 1.0}, item), bent.normals({}, item)))) for item in (near, far)
    ]
    strong = [np.percentile(item[item > 2.0], 90) for item in steep]
    np.testing.assert_allclose(strong[0], strong[1], rtol=0.1)


def test_picture_difference_due_to_wrinkles_increases_with_brow_raiser_intensity(portrait: Portrait):
    """Compare the forehead's contrast with and without wrinkles."""
    contrasts = []
    for intensity in (0.0, 0.25, 0.5, 0.75, 1.0):
        units = {"1": intensity, "2": intensity}
        bright = [portrait.draw(units, gain=gain).astype(float).mean(axis=2) for gain in (0.0, 1.0)]
        contrasts.append(np.abs(bright[1] - bright[0]).mean())
    assert contrasts[0] == 0.0
    assert np.all(np.diff(contrasts) > 0.0)

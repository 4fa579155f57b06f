import dataclasses

import numpy as np
import pytest
from scipy.ndimage import binary_erosion

from kinesic.body.arrays import Picture
from kinesic.face.display import DisplayError, open_offscreen_context
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Texture
from kinesic.face.render.camera import Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import (
    DRAFT_PRESET,
    FULL_PRESET,
    NORMAL_PRESET,
    QUALITY_PRESETS,
    Preset,
    Shadow,
)

from ..conftest import Gallery

CAMERA_YAWS = (-90, -30, 0, 60)
PICTURE_SIDE = 256
GRIN_UNITS = {"6": 1.0, "12": 1.0, "1": 1.0}


@pytest.fixture(scope="module")
def everything(gallery: Gallery) -> Picture:
    with gallery(FULL_PRESET, (96, 80)) as portrait:
        return portrait.draw(GRIN_UNITS)


def face_of(pixels: Picture) -> np.ndarray:
    """Return the (height, width) mask of skin by its colour."""
    red, blue = pixels[..., 0].astype(int), pixels[..., 2].astype(int)
    return red > blue + 5


def changed(one: Picture, other: Picture) -> np.ndarray:
    """Return the (height, width) mask of visible differences between two pictures."""
    return np.abs(one.astype(int) - other.astype(int)).max(axis=2) > 6


def test_portrait_picture_shows_a_face_on_a_plain_background(portrait: Portrait):
    pixels = portrait.draw({})
    assert pixels.shape == (PICTURE_SIDE, PICTURE_SIDE, 3)
    assert pixels.dtype == np.uint8
    assert 0.35 < face_of(pixels).mean() < 0.8
    assert not face_of(pixels)[: PICTURE_SIDE // 3, : PICTURE_SIDE // 10].any()
    assert pixels[..., 1].max() < 255  # no overexposure


def test_portrait_drawing_is_deterministic(portrait: Portrait):
    first = portrait.draw({"12": 0.6, "1": 0.3}, Camera(yaw_deg=20))
    portrait.draw({"26": 1.0})
    np.testing.assert_array_equal(portrait.draw({"12": 0.6, "1": 0.3}, Camera(yaw_deg=20)), first)


@pytest.mark.parametrize(
    ("unit", "rows"),
    [("1", (0.1, 0.5)), ("4", (0.05, 0.55)), ("12", (0.4, 0.9)), ("26", (0.5, 1.0)), ("43", (0.3, 0.5))],
)
def test_each_action_unit_changes_the_picture_mainly_in_its_region_of_the_face(
    portrait: Portrait, unit: str, rows: tuple[float, float]
):
    moved = np.nonzero(changed(portrait.draw({unit: 1.0}), portrait.draw({})))[0] / PICTURE_SIDE
    assert len(moved) > 5
    assert rows[0] <= np.percentile(moved, 10)
    assert np.percentile(moved, 90) <= rows[1]


def test_left_action_unit_changes_the_right_half_of_the_picture(portrait: Portrait):
    """Expect the left of a facing head on the picture's right."""
    columns = np.flatnonzero(changed(portrait.draw({"L12": 1.0}), portrait.draw({})).any(axis=0))
    assert np.median(columns) > PICTURE_SIDE / 2


@pytest.mark.parametrize("yaw", [*CAMERA_YAWS, 180])
def test_head_covers_over_40_percent_of_the_picture_from_all_listed_camera_yaws(portrait: Portrait, yaw: int):
    pixels = portrait.draw({}, Camera(yaw_deg=yaw))
    rows = np.flatnonzero(face_of(pixels).any(axis=1))
    assert rows.max() == PICTURE_SIDE - 1
    assert not np.isnan(pixels).any()
    assert (pixels != pixels[0, 0]).any(axis=2).mean() > 0.4


def test_left_and_right_views_of_a_face_are_mirrored(gallery: Gallery):
    actual = []
    with gallery(dataclasses.replace(DRAFT_PRESET, hair=False), (PICTURE_SIDE, PICTURE_SIDE)) as portrait:
        for yaw in (60.0, -60.0):
            portrait.pipeline.geometry.draw({}, Camera(yaw_deg=yaw))
            actual.append(portrait.pipeline.geometry.parts() > 0)
    left, right = actual
    assert (left != right[:, ::-1]).mean() < 0.01


@pytest.mark.soak
def test_drawing_another_portrait_does_not_change_later_pictures_of_the_first(portrait: Portrait):
    previous = portrait.draw({"4": 1.0})
    with Portrait("male", preset=DRAFT_PRESET, size=(64, 48)) as other:
        pixels = other.draw({})
        assert pixels.shape == (48, 64, 3)
        assert face_of(pixels).any()
        np.testing.assert_array_equal(portrait.draw({"4": 1.0}), previous)
    np.testing.assert_array_equal(portrait.draw({"4": 1.0}), previous)


def test_portrait_leaves_the_callers_opengl_context_open(drawable: None):
    with open_offscreen_context() as context:
        with Portrait(size=(32, 32), preset=DRAFT_PRESET, context=context) as portrait:
            assert face_of(portrait.draw({})).any()
        assert context.error == 0
        assert context.texture((2, 2), 4, bytes(16)).read() == bytes(16)


def test_rendering_preset_draft_has_no_wrinkles(gallery: Gallery):
    with gallery(DRAFT_PRESET, (64, 64)) as portrait:
        np.testing.assert_array_equal(portrait.draw({"4": 1.0}, gain=1.0), portrait.draw({"4": 1.0}, gain=0.0))


def test_rendering_preset_full_has_the_subdivided_mesh(gallery: Gallery):
    with gallery(dataclasses.replace(FULL_PRESET, samples=2), (64, 64)) as portrait:
        assert portrait.draw({"12": 1.0}).shape == (64, 64, 3)
        assert len(portrait.mesh.faces) > 20_000


@pytest.mark.parametrize(
    "off",
    [
        {"wrinkles": False},
        {"hair": False},
        {"occlusion": None},
        {"scattering": None},
        {"shadow": None},
        {"shadow": Shadow()},
        {"focus": None},
        {"smooth": False},
        {"samples": 1},
        {"subdivided": False},
        {"coarse": 1},
    ],
)
def test_each_rendering_effect_can_be_switched_off(gallery: Gallery, everything: Picture, off: dict[str, object]):
    with gallery(dataclasses.replace(FULL_PRESET, **off), (96, 80)) as portrait:
        without = portrait.draw(GRIN_UNITS)
    apart = np.abs(without.astype(int) - everything.astype(int)).max(axis=2)
    assert apart.max() > 0
    assert apart.mean() < 12.0  # still the same face


@pytest.mark.parametrize("preset", [DRAFT_PRESET, NORMAL_PRESET])
@pytest.mark.parametrize("yaw", [140, 160, 180, -140])
def test_neck_seen_from_behind_has_no_red_line_at_the_texture_seam(gallery: Gallery, preset: Preset, yaw: int):
    """Expect slowly changing colours, without face paint squeezed into the seam."""
    with gallery(dataclasses.replace(preset, hair=False), (512, 512)) as portrait:
        neck = portrait.draw({"4": 1.0, "12": 1.0}, Camera(yaw_deg=yaw))[315:430].astype(int)
    inside = binary_erosion(neck[..., 0] > 140, np.ones((9, 17)))
    assert inside.sum() > 10_000
    redness = neck[..., 0] - neck[..., 1]
    assert np.abs(np.diff(redness, axis=1))[inside[:, 1:]].max() <= 8


def test_rendering_presets_are_ordered_by_quality():
    assert list(QUALITY_PRESETS) == ["draft", "normal", "full"]


@pytest.mark.parametrize(
    ("units", "gain", "says"),
    [({"99": 1.0}, 1.0, "no action unit 99"), ({"1": 1.5}, 1.0, "1 is 1.5"), ({}, -1.0, "wrinkles -1 times")],
)
def test_error_of_a_portrait_names_the_invalid_argument(
    portrait: Portrait, units: dict[str, float], gain: float, says: str
):
    with pytest.raises(DisplayError, match=says):
        portrait.draw(units, gain=gain)


@pytest.mark.parametrize("size", [(0, 64), (64, 5000)])
def test_picture_size_out_of_range_is_rejected(size: tuple[int, int]):
    with pytest.raises(DisplayError, match="use 1 to 4096 per side"):
        Portrait(size=size)


@pytest.mark.parametrize(
    ("fields", "says"), [({"yaw_deg": float("nan")}, "yaw nan"), ({"distance": 0.1}, "0.1 m away")]
)
def test_portrait_camera_out_of_range_is_rejected(fields: dict[str, float], says: str):
    with pytest.raises(DisplayError, match=says):
        Camera(**fields)


def test_default_portrait_camera_looks_at_the_head():
    for yaw in (0.0, 37.0, 180.0):
        view = Camera(yaw_deg=yaw).view()
        np.testing.assert_allclose(view[:3, :3] @ view[:3, :3].T, np.eye(3), atol=1e-12)
        assert np.linalg.det(view[:3, :3]) > 0
    left_eye = Camera().view() @ (0.0, 0.03, 0.0, 1.0)
    assert left_eye[0] > 0.02  # to the right in the picture
    left_side = Camera(yaw_deg=90.0).view() @ (-0.055, 0.08, 0.0, 1.0)
    assert left_side[2] > -Camera().distance + 0.07  # nearer than the middle


def test_byte_textures_are_never_interpolated_in_the_presets_normal_and_full(
    drawable: None, monkeypatch: pytest.MonkeyPatch
):
    """Prevent pictures that depend on the driver's rounding of bytes."""
    made: list[Texture] = []
    real = GlContext.texture

    def texture(context: GlContext, *given: object, **named: object) -> Texture:
        made.append(real(context, *given, **named))
        return made[-1]

    monkeypatch.setattr(GlContext, "texture", texture)
    for preset in (NORMAL_PRESET, dataclasses.replace(FULL_PRESET, eyeshade=True)):
        with Portrait(preset=preset, size=(32, 32)) as portrait:
            portrait.draw(GRIN_UNITS)
            bytes_ = [item for item in made if item.dtype == "f1"]
            assert bytes_
            assert {item.filter for item in bytes_} == {(gl.GL_NEAREST, gl.GL_NEAREST)}
        made.clear()

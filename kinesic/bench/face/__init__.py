"""Measures the face: what occlusion costs and misses, its skin, wrinkles, lids and lips, and its frame rate."""

# A machine without OpenGL has every figure's name, and a reason instead of its value.

from collections.abc import Iterator
from typing import Literal, get_args

from kinesic.bench.face.lips import RATES, measure_lips
from kinesic.bench.face.stages import NAME as STAGE
from kinesic.bench.face.stages import stages_of
from kinesic.bench.figure import Figure
from kinesic.face.display import available
from kinesic.face.render.presets import PRESETS, TILES, Estimator, Pattern
from kinesic.speech.espeak_pool import espeak_fault

Better = Literal["lower", "higher"]

LIPS = "face.lips."
SIZES = (5, 11, 21)  # samples across, of Table 3.1
PICTURES = ((512, 512), (1024, 768))
FASTEST = 24.0  # [Hz] wanted of preset normal at the first of them
THESIS_MS = {  # Table 3.1, on a GTX 480: exact and separable
    ("crytek", 5): (3.2, 3.4),
    ("crytek", 11): (13.9, 5.8),
    ("crytek", 21): (49.7, 9.9),
    ("obscurance", 5): (3.5, 3.6),
    ("obscurance", 11): (14.8, 5.9),
    ("obscurance", 21): (51.9, 9.9),
    ("horizon", 5): (3.6, 3.5),
    ("horizon", 11): (15.0, 6.0),
    ("horizon", 21): (51.9, 10.2),
}


def bench() -> list[Figure]:
    """Measures every figure of the part."""
    reason = available()
    mute = reason or espeak_fault()
    values = {} if reason else _measured()
    if not mute:
        values |= measure_lips()
    return [
        Figure(name, values.get(name), unit, goal, better, (mute if name.startswith(LIPS) else reason) or _beside(name))
        for name, unit, goal, better in expected_figures()
    ]


def expected_figures() -> Iterator[tuple[str, str, float | None, Better]]:
    """Lists name, unit, goal and direction of each figure."""
    for preset in PRESETS:
        for width, height in PICTURES:
            normal = preset == "normal" and (width, height) == PICTURES[0]
            yield f"face.fps.{preset}_{width}x{height}", "Hz", FASTEST if normal else None, "higher"
            yield f"face.fps.{preset}_{width}x{height}_cpu", "ms", None, "lower"
    yield "face.fps.covered", "%", 40.0, "higher"
    yield "face.figure.draft_512x512", "Hz", FASTEST, "higher"
    yield "face.figure.normal_512x512", "Hz", None, "higher"
    yield "face.figure.filmed_1280x720", "Hz", None, "higher"
    yield "face.figure.linear_ms", "ms", None, "lower"
    yield "face.figure.dual_ms", "ms", None, "lower"
    for preset, drawn in PRESETS.items():
        for width, height in PICTURES:
            for stage in (*stages_of(drawn), "picture"):
                yield f"{STAGE}{preset}_{width}x{height}_{stage}", "ms", None, "lower"
    for estimator in get_args(Estimator):
        for size in SIZES:
            for kind in ("exact", "separable"):
                yield f"face.occlusion.{estimator}_{size}_{kind}", "ms", None, "lower"
            yield f"face.occlusion.{estimator}_{size}_ratio", "x", 4.0 if size == SIZES[-1] else None, "higher"
            yield f"face.occlusion.{estimator}_{size}_rmse", "", 0.02 if size == SIZES[-1] else None, "lower"
            yield f"face.occlusion.{estimator}_{size}_rmse_occluded", "", None, "lower"
    yield "face.occlusion.samples_21_exact", "count", None, "lower"
    yield "face.occlusion.samples_21_separable", "count", None, "lower"
    yield "face.occlusion.boxes_rmse", "", None, "lower"
    yield "face.occlusion.boxes_rmse_occluded", "", None, "lower"
    yield "face.occlusion.boxes_correlation", "", None, "higher"
    for pattern in get_args(Pattern):
        yield f"face.occlusion.boxes_{pattern}_rmse", "", None, "lower"
    for tile in TILES:
        yield f"face.occlusion.boxes_tile_{tile}_rmse", "", None, "lower"
    for name in ("one_axis", "one_axis_same_cost"):
        yield f"face.occlusion.boxes_{name}_rmse", "", None, "lower"
    yield "face.occlusion.lab_mean", "dE", None, "lower"
    yield "face.occlusion.lab_p95", "dE", None, "lower"
    yield "face.scattering.ratio", "x", None, "higher"
    yield "face.scattering.filtered", "%", None, "lower"
    yield "face.scattering.kept", "%", None, "higher"
    yield "face.scattering.kept_visible", "%", None, "higher"
    yield "face.scattering.levels_ratio", "x", None, "higher"
    yield "face.scattering.levels_kept", "%", None, "higher"
    yield "face.wrinkle.zero", "count", 0.0, "lower"
    yield "face.wrinkle.linear", "", 0.01, "lower"
    yield "face.wrinkle.outside", "", 1e-4, "lower"
    yield "face.wrinkle.mirror", "", 0.003, "lower"
    yield "face.wrinkle.back", "count", 0.0, "lower"
    yield "face.wrinkle.steepest", "deg", 65.0, "lower"
    yield "face.lids.uneven", "", 0.1, "lower"
    yield "face.lids.outside", "count", 0.0, "lower"
    for rate in RATES:
        yield f"{LIPS}{rate}_release_median", "ms", 20.0, "lower"
        yield f"{LIPS}{rate}_release_p95", "ms", 45.0, "lower"
        yield f"{LIPS}{rate}_open", "count", 0.0, "lower"
        yield f"{LIPS}{rate}_late", "count", 0.0, "lower"
        yield f"{LIPS}{rate}_fastest", "mm/s", 300.0, "lower"


def _measured() -> dict[str, float]:
    from kinesic.bench.face import eyes, figure, frame_rate, occlusion, scattering, stages, wrinkles  # noqa: PLC0415 - they need the names above

    return {
        **frame_rate.frames(PICTURES),
        **stages.measure_stages(PICTURES),
        **figure.measure_figure(),
        **occlusion.occlusion(SIZES),
        **scattering.scattering(),
        **wrinkles.measure_law_violations(),
        **eyes.measure_eyes(),
    }


def _beside(name: str) -> str:
    """What the thesis measured."""
    for (estimator, size), (exact, separable) in THESIS_MS.items():
        stem = f"face.occlusion.{estimator}_{size}_"
        if name == stem + "exact":
            return f"thesis, GTX 480: {exact:g} ms"
        if name == stem + "separable":
            return f"thesis, GTX 480: {separable:g} ms"
        if name == stem + "ratio":
            return f"thesis: {exact / separable:.2f}"
    return ""

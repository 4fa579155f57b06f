"""Benchmark of the face: occlusion, scattering, wrinkles, eyelids, lips and frame rate."""

# Without OpenGL every metric keeps its name and gives a reason instead of a value.

from collections.abc import Iterator
from typing import Literal, get_args

from kinesic.bench.face.lips import SPEECH_RATES, measure_lips
from kinesic.bench.face.prosody import measure_prosody
from kinesic.bench.face.stages import STAGE_PREFIX as STAGE_PREFIX
from kinesic.bench.face.stages import stages_of
from kinesic.bench.metric import Metric
from kinesic.face.display import find_display_problem
from kinesic.face.render.presets import QUALITY_PRESETS, TILE_SIZES, Estimator, Pattern
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.hibari.model import find_package
from kinesic.speech.voice import voice

Better = Literal["lower", "higher"]

LIP_PREFIX = "face.lips."
PROSODY_PREFIX = "face.prosody."
OCCLUSION_SIZES = (5, 11, 21)  # filter widths of ambient occlusion [samples], as in thesis Table 3.1
PICTURE_SIZES = ((512, 512), (1024, 768))  # [pixels] sizes of the timed pictures
MIN_FRAME_RATE = 24.0  # [Hz] frame rate goal of the face (preset normal) and full body (draft)
THESIS_MS = {  # (estimator, filter width) -> times [ms] of exact and separable blur on a GTX 480: the thesis, Table 3.1
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


def bench() -> list[Metric]:
    """Measure the face's rendering quality and speed, lids, lips and prosody motion."""
    reason = find_display_problem()
    lips_reason = reason or espeak_fault()
    prosody_reason = reason or ("" if find_package() else "hibari-tts is not installed")
    values = {} if reason else _measure_values()
    if not lips_reason:
        values |= measure_lips()
    if not prosody_reason:
        values |= measure_prosody(voice("hibari"))
    return [
        Metric(
            name,
            values.get(name),
            unit,
            goal,
            better,
            _choose_reason(name, reason, lips_reason, prosody_reason) or _quote_thesis(name),
        )
        for name, unit, goal, better in expected_metrics()
    ]


def expected_metrics() -> Iterator[tuple[str, str, float | None, Better]]:
    """Yield name, unit, goal and preferred direction of each face metric."""
    for preset in QUALITY_PRESETS:
        for width, height in PICTURE_SIZES:
            normal = preset == "normal" and (width, height) == PICTURE_SIZES[0]
            yield f"face.fps.{preset}_{width}x{height}", "Hz", MIN_FRAME_RATE if normal else None, "higher"
            yield f"face.fps.{preset}_{width}x{height}_cpu", "ms", None, "lower"
    yield "face.fps.covered", "%", 40.0, "higher"
    yield "face.figure.draft_512x512", "Hz", MIN_FRAME_RATE, "higher"
    yield "face.figure.normal_512x512", "Hz", None, "higher"
    yield "face.figure.filmed_1280x720", "Hz", None, "higher"
    yield "face.figure.linear_ms", "ms", None, "lower"
    yield "face.figure.dual_ms", "ms", None, "lower"
    for preset, drawn in QUALITY_PRESETS.items():
        for width, height in PICTURE_SIZES:
            for stage in (*stages_of(drawn), "picture"):
                yield f"{STAGE_PREFIX}{preset}_{width}x{height}_{stage}", "ms", None, "lower"
    for estimator in get_args(Estimator):
        for size in OCCLUSION_SIZES:
            has_goals = size == OCCLUSION_SIZES[-1] and estimator != "depth"  # whose exact pass is cheap
            for kind in ("exact", "separable"):
                yield f"face.occlusion.{estimator}_{size}_{kind}", "ms", None, "lower"
            yield (
                f"face.occlusion.{estimator}_{size}_ratio",
                "x",
                4.0 if has_goals else None,
                "higher",
            )
            yield f"face.occlusion.{estimator}_{size}_rmse", "", 0.02 if has_goals else None, "lower"
            yield f"face.occlusion.{estimator}_{size}_rmse_occluded", "", None, "lower"
    yield "face.occlusion.samples_21_exact", "count", None, "lower"
    yield "face.occlusion.samples_21_separable", "count", None, "lower"
    yield "face.occlusion.boxes_rmse", "", None, "lower"
    yield "face.occlusion.boxes_rmse_occluded", "", None, "lower"
    yield "face.occlusion.boxes_correlation", "", None, "higher"
    for pattern in get_args(Pattern):
        yield f"face.occlusion.boxes_{pattern}_rmse", "", None, "lower"
    for tile in TILE_SIZES:
        yield f"face.occlusion.boxes_tile_{tile}_rmse", "", None, "lower"
    for name in ("one_axis", "one_axis_same_cost"):
        yield f"face.occlusion.boxes_{name}_rmse", "", None, "lower"
    yield "face.occlusion.lab_mean", "dE", None, "lower"
    yield "face.occlusion.lab_p95", "dE", None, "lower"
    yield "face.occlusion.buffer_lab_mean", "dE", None, "lower"
    yield "face.occlusion.buffer_lab_p95", "dE", None, "lower"
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
    for rate in SPEECH_RATES:
        yield f"{LIP_PREFIX}{rate}_release_median", "ms", 20.0, "lower"
        yield f"{LIP_PREFIX}{rate}_release_p95", "ms", 45.0, "lower"
        yield f"{LIP_PREFIX}{rate}_open", "count", 0.0, "lower"
        yield f"{LIP_PREFIX}{rate}_late", "count", 0.0, "lower"
        yield f"{LIP_PREFIX}{rate}_fastest", "mm/s", 300.0, "lower"
    yield f"{PROSODY_PREFIX}accents_moved", "%", 60.0, "higher"
    yield f"{PROSODY_PREFIX}brows", "1/min", None, "higher"
    yield f"{PROSODY_PREFIX}blinks_fewest", "1/min", 10.0, "higher"
    yield f"{PROSODY_PREFIX}blinks_most", "1/min", 25.0, "lower"


def _choose_reason(name: str, reason: str | None, lips_reason: str | None, prosody_reason: str) -> str | None:
    """Return the reason why a metric cannot be measured.

    It is empty or None if it can be measured.
    """
    if name.startswith(PROSODY_PREFIX):
        return prosody_reason
    return lips_reason if name.startswith(LIP_PREFIX) else reason


def _measure_values() -> dict[str, float]:
    from kinesic.bench.face import eyes, frame_rate, full_body, occlusion, scattering, stages, wrinkles  # noqa: PLC0415 - they need the names above

    return {
        **frame_rate.measure_frame_rates(PICTURE_SIZES),
        **stages.measure_stages(PICTURE_SIZES),
        **full_body.measure_full_body(),
        **occlusion.measure_occlusion(OCCLUSION_SIZES),
        **scattering.measure_scattering(),
        **wrinkles.measure_law_violations(),
        **eyes.measure_eyes(),
    }


def _quote_thesis(name: str) -> str:
    """Return the thesis' value of a face metric as a note.

    The note is empty for metrics without a printed value.
    """
    for (estimator, size), (exact, separable) in THESIS_MS.items():
        stem = f"face.occlusion.{estimator}_{size}_"
        if name == stem + "exact":
            return f"thesis, GTX 480: {exact:g} ms"
        if name == stem + "separable":
            return f"thesis, GTX 480: {separable:g} ms"
        if name == stem + "ratio":
            return f"thesis: {exact / separable:.2f}"
    return ""

"""Benchmark of the face: metric names, and values if drawing is possible."""

import dataclasses
from functools import partial
from time import perf_counter

import numpy as np
import pytest

from kinesic.bench import face
from kinesic.cli.bench import measure
from kinesic.face.display import find_display_problem, open_offscreen_context
from kinesic.face.render.camera import FRONT_CAMERA
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import Focus

drawable = pytest.mark.skipif(find_display_problem() is not None, reason=find_display_problem() or "")


def test_missing_opengl_makes_every_face_metric_null_with_a_reason(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(face, "find_display_problem", lambda: "no OpenGL here")
    metrics = measure("face")
    assert {metric.value for metric in metrics} == {None}
    assert {metric.why for metric in metrics} == {"no OpenGL here"}
    names = [metric.name for metric in metrics]
    assert len(set(names)) == len(names)
    for stem in (
        "face.fps.",
        "face.stage.",
        "face.occlusion.",
        "face.scattering.",
        "face.wrinkle.",
        "face.lids.",
        "face.lips.",
    ):
        assert any(name.startswith(stem) for name in names)


@pytest.mark.soak
@drawable
def test_measured_wrinkle_errors_meet_their_benchmark_goals(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import wrinkles as laws  # noqa: PLC0415 - needs OpenGL

    some = laws.load_wrinkles()[::4]  # a sample; all are tested in tests/face/render/test_wrinkles.py
    monkeypatch.setattr(laws, "PICTURE_SIZE", (256, 256))
    monkeypatch.setattr(laws, "load_wrinkles", lambda: some)
    values = laws.measure_law_violations()
    goals = {name: goal for name, _, goal, _ in face.expected_metrics() if name.startswith("face.wrinkle.")}
    assert values.keys() == goals.keys()
    for name, goal in goals.items():
        assert goal is not None
        assert values[name] <= goal, name


@pytest.mark.soak
@drawable
def test_eyelids_close_evenly_over_the_eyeballs(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import eyes  # noqa: PLC0415 - needs OpenGL

    monkeypatch.setattr(eyes, "PICTURE_SIDE", 384)
    values = eyes.measure_eyes(8)
    assert 0.0 < values["face.lids.uneven"] <= 0.1
    assert values["face.lids.outside"] == 0.0


@pytest.mark.soak
@drawable
def test_thresholded_skin_scattering_keeps_most_of_the_visible_effect(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import scattering  # noqa: PLC0415 - needs OpenGL

    monkeypatch.setattr(scattering, "TIMING_REPETITIONS", 1)
    monkeypatch.setattr(scattering, "Portrait", partial(Portrait, size=(256, 256)))
    values = scattering.measure_scattering()
    assert 0.0 < values["face.scattering.filtered"] < 50.0
    assert values["face.scattering.kept"] > 68.0
    assert values["face.scattering.kept_visible"] > 80.0
    assert values["face.scattering.ratio"] > 0.0
    assert 40.0 < values["face.scattering.levels_kept"] < 100.0


@pytest.mark.soak
@drawable
def test_ambient_occlusion_benchmark_has_all_metrics_and_small_errors(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import occlusion  # noqa: PLC0415 - needs OpenGL

    monkeypatch.setattr(occlusion, "TIMING_REPETITIONS", 1)
    monkeypatch.setattr(occlusion, "TABLE_SIZE", (128, 96))
    monkeypatch.setattr(face, "OCCLUSION_SIZES", face.OCCLUSION_SIZES[-1:])  # all sizes use the same programs
    values = occlusion.measure_occlusion(face.OCCLUSION_SIZES)
    assert values.keys() == {name for name, *_ in face.expected_metrics() if name.startswith("face.occlusion.")}
    assert values["face.occlusion.boxes_rmse"] < 0.04
    assert values["face.occlusion.boxes_correlation"] > 0.97
    assert values["face.occlusion.boxes_rmse_occluded"] > values["face.occlusion.boxes_rmse"]
    assert values["face.occlusion.boxes_one_axis_rmse"] > 1.2 * values["face.occlusion.boxes_rmse"]
    assert values["face.occlusion.samples_21_exact"] > 4 * values["face.occlusion.samples_21_separable"]


@drawable
def test_face_frame_rate_is_measured_for_the_draft_preset(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import frame_rate  # noqa: PLC0415 - needs OpenGL

    monkeypatch.setattr(frame_rate, "MEASURED_FRAMES", 2)
    monkeypatch.setattr(frame_rate, "SLOW_PRESET_FRAMES", 1)
    draft = {"draft": dataclasses.replace(frame_rate.DRAFT_PRESET)}
    monkeypatch.setattr(frame_rate, "QUALITY_PRESETS", draft)
    values = frame_rate.measure_frame_rates(((64, 64),))
    assert values["face.fps.draft_64x64"] > 0.0
    assert values["face.fps.covered"] > 40.0


@drawable
@pytest.mark.parametrize("of_card", [False, True])
def test_each_face_rendering_stage_is_timed_by_a_gpu_or_cpu_clock(monkeypatch: pytest.MonkeyPatch, of_card: bool):
    """Check that the benchmark times every stage of the rendering pipeline."""
    from kinesic.bench.face import clock, stages  # noqa: PLC0415 - needs OpenGL

    monkeypatch.setattr(stages, "MEASURED_PICTURES", 1)
    monkeypatch.setattr(clock, "BUSY_TIME", 1e-4)
    monkeypatch.setattr(clock, "SOFTWARE_RENDERERS", ("no renderer",) if of_card else ("",))
    normal = face.QUALITY_PRESETS["normal"]
    drawn = dataclasses.replace(normal, focus=Focus(), samples=2) if of_card else normal
    monkeypatch.setattr(stages, "QUALITY_PRESETS", {"normal": drawn})
    values = stages.measure_stages([(48, 48)])
    names = [name.rsplit("_", 1)[1] for name in values]
    assert names == [*stages.stages_of(drawn), "picture"]
    assert min(values.values()) > 0.0
    with Portrait(preset=drawn, size=(48, 48)) as portrait, portrait.pipeline.geometry.context:
        assert [name for name, _ in portrait.pipeline.stages({}, FRONT_CAMERA, 1.0)] == names[:-1]


@drawable
def test_measured_drawing_time_excludes_command_queueing():
    """Check that an empty drawing takes less time than the filler work."""
    from kinesic.bench.face.clock import DrawingClock  # noqa: PLC0415 - needs OpenGL

    with open_offscreen_context() as context:
        clock = DrawingClock(context, of_card=True)
        began = perf_counter()
        counted = clock.milliseconds(lambda: None)
        assert counted < 0.5 * 1e3 * (perf_counter() - began)


@pytest.mark.soak
@drawable
def test_face_benchmark_times_drawing_and_skinning_of_the_full_body(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import full_body  # noqa: PLC0415 - needs OpenGL

    monkeypatch.setattr(full_body, "MEASURED_FRAMES", 2)
    monkeypatch.setattr(
        full_body, "TIMED_PICTURES", dict.fromkeys(full_body.TIMED_PICTURES, (full_body.DRAFT_PRESET, (64, 64)))
    )
    values = full_body.measure_full_body()
    assert values.keys() == {name for name, *_ in face.expected_metrics() if name.startswith("face.figure.")}
    assert min(values.values()) > 0.0


def test_lab_conversion_matches_reference_colours_and_equal_colours_have_no_difference():
    from kinesic.bench.face.occlusion import colour_difference, lab  # noqa: PLC0415 - imported where used

    grey, white = np.full((1, 1, 3), 119, np.uint8), np.full((1, 1, 3), 255, np.uint8)
    np.testing.assert_allclose(lab(white)[0, 0], (100.0, 0.0, 0.0), atol=1e-2)
    np.testing.assert_allclose(lab(grey)[0, 0], (50.0, 0.0, 0.0), atol=0.3)
    red = np.array([[[255, 0, 0]]], np.uint8)
    np.testing.assert_allclose(lab(red)[0, 0], (53.24, 80.09, 67.20), atol=0.05)
    assert colour_difference(grey, grey)[0, 0] == 0.0

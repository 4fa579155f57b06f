"""The figures of the face: names everywhere, values where something can be drawn."""

import dataclasses
from functools import partial
from time import perf_counter

import numpy as np
import pytest

from kinesic.bench import face
from kinesic.cli.bench import measure
from kinesic.face.display import available, offscreen
from kinesic.face.render.camera import FRONT
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import Focus

drawable = pytest.mark.skipif(available() is not None, reason=available() or "")


def test_without_opengl_every_figure_has_a_reason(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(face, "available", lambda: "no OpenGL here")
    figures = measure("face")
    assert {figure.value for figure in figures} == {None}
    assert {figure.why for figure in figures} == {"no OpenGL here"}
    names = [figure.name for figure in figures]
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


@drawable
def test_the_laws_of_wrinkles_hold(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import wrinkles as laws  # noqa: PLC0415 - where it can be drawn

    some = laws.wrinkles()[::4]  # of all, one by one: tests/face/render/test_wrinkles.py
    monkeypatch.setattr(laws, "SIZE", (256, 256))
    monkeypatch.setattr(laws, "wrinkles", lambda: some)
    found = laws.measure_law_violations()
    wanted = {name: goal for name, _, goal, _ in face.expected_figures() if name.startswith("face.wrinkle.")}
    assert found.keys() == wanted.keys()
    for name, goal in wanted.items():
        assert goal is not None
        assert found[name] <= goal, name


@drawable
def test_lids_close_evenly_and_no_eyeball_shows_through_them(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import eyes  # noqa: PLC0415 - where it can be drawn

    monkeypatch.setattr(eyes, "SIDE", 384)
    found = eyes.measure_eyes(8)
    assert 0.0 < found["face.lids.uneven"] <= 0.1
    assert found["face.lids.outside"] == 0.0


@drawable
def test_scattering_keeps_most_of_what_is_seen(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import scattering  # noqa: PLC0415 - where it can be drawn

    monkeypatch.setattr(scattering, "REPETITIONS", 1)
    monkeypatch.setattr(scattering, "Portrait", partial(Portrait, size=(256, 256)))
    found = scattering.scattering()
    assert 0.0 < found["face.scattering.filtered"] < 50.0
    assert found["face.scattering.kept"] > 50.0
    assert found["face.scattering.kept_visible"] > 80.0
    assert found["face.scattering.ratio"] > 0.0
    assert 40.0 < found["face.scattering.levels_kept"] < 100.0


@drawable
def test_occlusion_has_a_row_for_each_estimator_and_is_near_to_exact(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import occlusion  # noqa: PLC0415 - where it can be drawn

    monkeypatch.setattr(occlusion, "REPETITIONS", 1)
    monkeypatch.setattr(occlusion, "TABLE_SIZE", (128, 96))
    monkeypatch.setattr(face, "SIZES", face.SIZES[-1:])  # the others are drawn by the same programs
    found = occlusion.occlusion(face.SIZES)
    assert found.keys() == {name for name, *_ in face.expected_figures() if name.startswith("face.occlusion.")}
    assert found["face.occlusion.boxes_rmse"] < 0.04
    assert found["face.occlusion.boxes_correlation"] > 0.97
    assert found["face.occlusion.boxes_rmse_occluded"] > found["face.occlusion.boxes_rmse"]
    assert found["face.occlusion.boxes_one_axis_rmse"] > 1.2 * found["face.occlusion.boxes_rmse"]
    assert found["face.occlusion.samples_21_exact"] > 4 * found["face.occlusion.samples_21_separable"]


@drawable
def test_frames_are_counted_for_every_preset(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import frame_rate  # noqa: PLC0415 - where it can be drawn

    monkeypatch.setattr(frame_rate, "FRAMES", 2)
    monkeypatch.setattr(frame_rate, "SLOW_FRAMES", 1)
    draft = {"draft": dataclasses.replace(frame_rate.DRAFT)}
    monkeypatch.setattr(frame_rate, "PRESETS", draft)
    found = frame_rate.frames(((64, 64),))
    assert found["face.fps.draft_64x64"] > 0.0
    assert found["face.fps.covered"] > 40.0


@drawable
@pytest.mark.parametrize("of_card", [False, True])
def test_each_stage_of_a_picture_is_timed_by_either_clock(monkeypatch: pytest.MonkeyPatch, of_card: bool):
    """The pipeline's own stages are those that the bench names: a figure for each, whoever's clock it is."""
    from kinesic.bench.face import clock, stages  # noqa: PLC0415 - where it can be drawn

    monkeypatch.setattr(stages, "PICTURES", 1)
    monkeypatch.setattr(clock, "BUSY", 1e-4)
    monkeypatch.setattr(clock, "SOFTWARE", ("nothing that draws",) if of_card else ("",))
    normal = face.PRESETS["normal"]
    drawn = dataclasses.replace(normal, focus=Focus(), samples=2) if of_card else normal
    monkeypatch.setattr(stages, "PRESETS", {"normal": drawn})
    found = stages.measure_stages([(48, 48)])
    names = [name.rsplit("_", 1)[1] for name in found]
    assert names == [*stages.stages_of(drawn), "picture"]
    assert min(found.values()) > 0.0
    with Portrait(preset=drawn, size=(48, 48)) as portrait, portrait.pipeline.geometry.context:
        assert [name for name, _ in portrait.pipeline.stages({}, FRONT, 1.0)] == names[:-1]


@drawable
def test_a_card_is_busy_while_it_is_asked_for_what_is_timed():
    """What is queued before is not counted: nothing takes far less than what keeps the card busy."""
    from kinesic.bench.face.clock import Clock  # noqa: PLC0415 - where it can be drawn

    with offscreen() as context:
        clock = Clock(context, of_card=True)
        began = perf_counter()
        counted = clock.milliseconds(lambda: None)
        assert counted < 0.5 * 1e3 * (perf_counter() - began)


@drawable
def test_a_figure_is_drawn_and_its_skin_follows(monkeypatch: pytest.MonkeyPatch):
    from kinesic.bench.face import figure  # noqa: PLC0415 - where it can be drawn

    monkeypatch.setattr(figure, "FRAMES", 2)
    monkeypatch.setattr(figure, "DRAWN", dict.fromkeys(figure.DRAWN, (figure.DRAFT, (64, 64))))
    found = figure.measure_figure()
    assert found.keys() == {name for name, *_ in face.expected_figures() if name.startswith("face.figure.")}
    assert min(found.values()) > 0.0


def test_colours_are_apart_as_people_see_them():
    from kinesic.bench.face.occlusion import colour_difference, lab  # noqa: PLC0415 - where it is called

    grey, white = np.full((1, 1, 3), 119, np.uint8), np.full((1, 1, 3), 255, np.uint8)
    np.testing.assert_allclose(lab(white)[0, 0], (100.0, 0.0, 0.0), atol=1e-2)
    np.testing.assert_allclose(lab(grey)[0, 0], (50.0, 0.0, 0.0), atol=0.3)
    red = np.array([[[255, 0, 0]]], np.uint8)
    np.testing.assert_allclose(lab(red)[0, 0], (53.24, 80.09, 67.20), atol=0.05)
    assert colour_difference(grey, grey)[0, 0] == 0.0

"""Tests of effects: changed presets and visible differences."""

from dataclasses import fields, replace

import numpy as np
import pytest

from kinesic.face.display import DisplayError
from kinesic.face.render.effects import Effects, read_focus
from kinesic.face.render.presets import (
    DRAFT_PRESET,
    FULL_PRESET,
    NORMAL_PRESET,
    QUALITY_PRESETS,
    Focus,
    Occlusion,
    Preset,
    Scattering,
    Shadow,
)

from ..conftest import Gallery


@pytest.mark.parametrize("preset", QUALITY_PRESETS.values())
def test_rendering_options_without_effects_keep_the_quality_preset(preset: Preset):
    assert Effects().apply_to(preset) == preset


def test_occlusion_options_override_only_the_given_fields_of_a_rendering_preset():
    assert Effects(occlusion="none").apply_to(FULL_PRESET).occlusion is None
    assert Effects(occlusion="exact").apply_to(FULL_PRESET).occlusion == replace(FULL_PRESET.occlusion, exact=True)
    assert Effects(occlusion="one-axis", size=41).apply_to(DRAFT_PRESET).occlusion == Occlusion(size=41, axes=1)
    assert Effects(occlusion="separable").apply_to(NORMAL_PRESET) == NORMAL_PRESET
    requested = Effects(estimator="crytek", falloff="gaussian", pattern="noise", tile=6).apply_to(FULL_PRESET).occlusion
    assert requested == Occlusion(size=21, estimator="crytek", falloff="gaussian", pattern="noise", tile=6)
    assert Effects(tile=3).apply_to(DRAFT_PRESET).occlusion == Occlusion(tile=3)


def test_scattering_shadow_and_eyeshade_options_change_a_rendering_preset():
    assert Effects(scattering="none", shadow="none").apply_to(NORMAL_PRESET) == replace(
        NORMAL_PRESET, scattering=None, shadow=None
    )
    assert Effects(scattering="everywhere").apply_to(NORMAL_PRESET).scattering == Scattering(threshold=1.0)
    assert Effects(scattering="adaptive").apply_to(FULL_PRESET).scattering == Scattering(steps=5)
    assert Effects(scattering="levels").apply_to(DRAFT_PRESET).scattering == Scattering(
        threshold=1.0, steps=5, levels=3
    )
    assert Effects(shadow="coloured", eyeshade=True).apply_to(DRAFT_PRESET) == replace(
        DRAFT_PRESET, shadow=Shadow(coloured=True), eyeshade=True
    )
    assert Effects(shadow="plain").apply_to(FULL_PRESET).shadow == replace(FULL_PRESET.shadow, coloured=False)


@pytest.mark.parametrize(
    ("text", "focus"),
    [
        ("none", None),
        ("eyes", Focus()),
        ("0.8", Focus(plane=0.8)),
        ("0.75:1.25", Focus(plane=1.0, within=0.25)),
        ("1.25:0.75", Focus(plane=1.0, within=0.25)),
    ],
)
def test_focus_option_text_becomes_a_focus_plane_and_range(text: str, focus: Focus | None):
    assert read_focus(text) == focus
    assert Effects(focus=text).apply_to(FULL_PRESET).focus == focus


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("nose", "focus 'nose': write eyes, a distance such as 0.8, or two such as 0.75:0.85"),
        ("1:2:3", "focus '1:2:3': write eyes"),
        ("0.01", "focus at 0.01 m; use 0.1 to 7 m from the camera"),
        ("nan", "focus at nan m"),
    ],
)
def test_invalid_focus_option_text_is_rejected(text: str, says: str):
    with pytest.raises(DisplayError, match=says):
        read_focus(text)


VISIBLE_CHANGES = {
    "occlusion": "one-axis",
    "size": 41,
    "estimator": "crytek",
    "falloff": "gaussian",
    "pattern": "noise",
    "tile": 8,
    "scattering": "levels",
    "shadow": "none",
    "focus": "0.95",
    "eyeshade": True,
}


@pytest.mark.parametrize("name", [field.name for field in fields(Effects)])
def test_each_effect_changes_the_head_but_not_the_background(gallery: Gallery, name: str):
    usual, other = NORMAL_PRESET, Effects(**{name: VISIBLE_CHANGES[name]}).apply_to(NORMAL_PRESET)
    pictures = []
    for preset in (usual, other):
        with gallery(preset, (128, 128)) as portrait:
            pictures.append(portrait.draw({"12": 0.5}).astype(int))
            head = portrait.pipeline.geometry.parts() > 0
    changed = np.abs(pictures[1] - pictures[0]).max(axis=2)
    assert changed[head].max() >= 2
    assert changed[:12, :12].max() <= 1  # blur does not change the background except by rounding


def test_coloured_shadow_tints_skin_under_an_eyeshade(gallery: Gallery):
    pictures = []
    for shadow in ("plain", "coloured"):
        with gallery(Effects(shadow=shadow, eyeshade=True).apply_to(DRAFT_PRESET), (128, 128)) as portrait:
            pictures.append(portrait.draw({}).astype(int))
    apart = pictures[0] - pictures[1]
    tinted = apart.max(axis=2) > 10
    assert 0.005 < tinted.mean() < 0.2
    assert apart[tinted][:, 0].mean() > 2 * apart[tinted][:, 1].mean()  # red is absorbed more than green

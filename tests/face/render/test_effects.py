"""Each effect by a word: what it makes of a preset, and that it is seen where it must be and nowhere else."""

from dataclasses import fields, replace

import numpy as np
import pytest

from kinesic.face.display import DisplayError
from kinesic.face.render.effects import Effects, read_focus
from kinesic.face.render.presets import DRAFT, FULL, NORMAL, PRESETS, Focus, Occlusion, Preset, Scattering, Shadow

from ..conftest import Gallery


@pytest.mark.parametrize("preset", PRESETS.values())
def test_nothing_asked_is_the_preset(preset: Preset):
    assert Effects().applied(preset) == preset


def test_occlusion_is_what_was_asked_and_else_as_it_was():
    assert Effects(occlusion="none").applied(FULL).occlusion is None
    assert Effects(occlusion="exact").applied(FULL).occlusion == replace(FULL.occlusion, exact=True)
    assert Effects(occlusion="one-axis", size=41).applied(DRAFT).occlusion == Occlusion(size=41, axes=1)
    assert Effects(occlusion="separable").applied(NORMAL) == NORMAL
    asked = Effects(estimator="crytek", falloff="gaussian", pattern="noise", tile=6).applied(FULL).occlusion
    assert asked == Occlusion(size=21, estimator="crytek", falloff="gaussian", pattern="noise", tile=6)
    assert Effects(tile=3).applied(DRAFT).occlusion == Occlusion(tile=3)


def test_scattering_shadow_and_eyeshade_are_what_was_asked():
    assert Effects(scattering="none", shadow="none").applied(NORMAL) == replace(NORMAL, scattering=None, shadow=None)
    assert Effects(scattering="everywhere").applied(NORMAL).scattering == Scattering(threshold=1.0)
    assert Effects(scattering="adaptive").applied(FULL).scattering == Scattering(steps=5)
    assert Effects(scattering="levels").applied(DRAFT).scattering == Scattering(threshold=1.0, steps=5, levels=3)
    assert Effects(shadow="coloured", eyeshade=True).applied(DRAFT) == replace(
        DRAFT, shadow=Shadow(coloured=True), eyeshade=True
    )
    assert Effects(shadow="plain").applied(FULL).shadow == replace(FULL.shadow, coloured=False)


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
def test_a_focus_is_read(text: str, focus: Focus | None):
    assert read_focus(text) == focus
    assert Effects(focus=text).applied(FULL).focus == focus


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("nose", "focus 'nose': write eyes, a distance such as 0.8, or two such as 0.75:0.85"),
        ("1:2:3", "focus '1:2:3': write eyes"),
        ("0.01", "focus at 0.01 m; it may be 0.1 to 7 m from the camera"),
        ("nan", "focus at nan m"),
    ],
)
def test_no_focus_is_told(text: str, says: str):
    with pytest.raises(DisplayError, match=says):
        read_focus(text)


SEEN = {
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
def test_each_effect_changes_the_head_and_not_what_is_behind_it(gallery: Gallery, name: str):
    usual, other = NORMAL, Effects(**{name: SEEN[name]}).applied(NORMAL)
    pictures = []
    for preset in (usual, other):
        with gallery(preset, (128, 128)) as portrait:
            pictures.append(portrait.draw({"12": 0.5}).astype(int))
            head = portrait.pipeline.geometry.parts() > 0
    changed = np.abs(pictures[1] - pictures[0]).max(axis=2)
    assert changed[head].max() >= 3
    assert changed[:12, :12].max() <= 1  # a blurred backdrop is the backdrop, but for rounding


def test_a_coloured_shadow_tints_what_lies_under_an_eyeshade(gallery: Gallery):
    pictures = []
    for shadow in ("plain", "coloured"):
        with gallery(Effects(shadow=shadow, eyeshade=True).applied(DRAFT), (128, 128)) as portrait:
            pictures.append(portrait.draw({}).astype(int))
    apart = pictures[0] - pictures[1]
    tinted = apart.max(axis=2) > 10
    assert 0.005 < tinted.mean() < 0.2
    assert apart[tinted][:, 0].mean() > 2 * apart[tinted][:, 1].mean()  # red is taken out more than green

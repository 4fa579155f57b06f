"""What adaptive scattering saves, and how much of the effect it keeps (thesis 5.2)."""

from dataclasses import replace
from functools import partial
from statistics import median

from kinesic.bench.face.clock import Clock
from kinesic.bench.face.occlusion import colour_difference
from kinesic.body.arrays import Flags, Picture
from kinesic.face.assets.action_units import intensities
from kinesic.face.render.camera import FRONT
from kinesic.face.render.pipeline import pixels_per_metre
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL, Preset, Scattering
from kinesic.face.render.wrinkles import shares

UNITS = {"6": 0.6, "12": 0.8, "26": 0.4}
REPETITIONS = 9
VISIBLE = 1.0  # of a difference in Lab
ADAPTIVE = Scattering()  # as in preset normal
EVERYWHERE = Scattering(threshold=1.0)
WHOLE = Scattering(threshold=1.0, steps=5)  # as in preset full
LEVELS = replace(WHOLE, levels=3)


def scattering() -> dict[str, float]:
    """Time of the whole filter over that of the adaptive one; shares of skin filtered and of the effect that is kept.

    The effect is the difference in Lab between no scattering and scattering everywhere; what is kept of it is what the
    adaptive picture's own difference to everywhere leaves, on all skin and where the effect is visible. In levels, all
    skin is filtered, by more samples the more it is occluded (Figures 5.2 and 5.3).
    """
    none = _drawn(None)[0]
    full, shared, _ = _drawn(EVERYWHERE)
    adaptive, filtered, skin = _drawn(ADAPTIVE)
    effect, missed = colour_difference(none, full)[skin], colour_difference(adaptive, full)[skin]
    seen = effect > VISIBLE
    whole, levels = _drawn(WHOLE)[0], _drawn(LEVELS)[0]
    whole_effect, in_levels = colour_difference(none, whole)[skin], colour_difference(levels, whole)[skin]
    return {
        "face.scattering.ratio": _ratio(EVERYWHERE, ADAPTIVE),
        "face.scattering.filtered": 100.0 * filtered / shared,
        "face.scattering.kept": 100.0 * (1.0 - float(missed.sum() / effect.sum())),
        "face.scattering.kept_visible": 100.0 * (1.0 - float(missed[seen].sum() / effect[seen].sum())),
        "face.scattering.levels_ratio": _ratio(WHOLE, LEVELS),
        "face.scattering.levels_kept": 100.0 * (1.0 - float(in_levels.sum() / whole_effect.sum())),
    }


def _drawn(settings: Scattering | None) -> tuple[Picture, float, Flags]:
    """A picture; the share of it that was filtered; where there is skin."""
    with Portrait(preset=_preset(settings)) as portrait:
        pixels, pipeline = portrait.draw(UNITS), portrait.pipeline
        with pipeline.geometry.context:
            skin = pipeline.geometry.parts() == 1
            return pixels, pipeline.scatter.marked() if pipeline.scatter else 0.0, skin


def _ratio(whole: Scattering, part: Scattering) -> float:
    """Time of the filter over all skin by that of one that does less, marks and all, by turns."""
    with Portrait(preset=_preset(whole)) as full, Portrait(preset=_preset(part)) as adaptive:
        scale = pixels_per_metre(FRONT, full.size[1])
        clocks = [_clock(full), _clock(adaptive)]
        times: tuple[list[float], list[float]] = ([], [])
        for _ in range(REPETITIONS):
            for portrait, clock, found in zip((full, adaptive), clocks, times, strict=True):
                portrait.draw(UNITS)
                pipeline = portrait.pipeline
                with clock.context:
                    _, bent = pipeline.relief.draw(shares(intensities(UNITS)))
                    if pipeline.scatter:
                        found.append(clock.milliseconds(partial(pipeline.scatter.draw, bent, scale)))
    return median(times[0]) / median(times[1])


def _clock(portrait: Portrait) -> Clock:
    with portrait.pipeline.geometry.context as context:
        return Clock(context)


def _preset(settings: Scattering | None) -> Preset:
    """Preset normal; smooth edges would blur what is compared."""
    return replace(NORMAL, scattering=settings, smooth=False)

"""Benchmark of adaptive skin scattering: speed and accuracy (thesis 5.2)."""

from dataclasses import replace
from functools import partial
from statistics import median

from kinesic.bench.face.clock import DrawingClock
from kinesic.bench.face.occlusion import colour_difference
from kinesic.body.arrays import Flags, Picture
from kinesic.face.assets.action_units import read_intensities
from kinesic.face.render.camera import FRONT_CAMERA
from kinesic.face.render.pipeline import compute_pixel_scale
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET, Preset, Scattering
from kinesic.face.render.wrinkles import compute_map_strengths

SMILE_UNITS = {"6": 0.6, "12": 0.8, "26": 0.4}  # action units of the drawn smile, with intensities
TIMING_REPETITIONS = 9  # number of timed drawings per scattering setting
VISIBLE_DIFFERENCE = 1.0  # smallest visible colour difference in L*a*b*
ADAPTIVE_SETTINGS = Scattering()  # settings of preset "normal", which filter where scattering is visible
EVERYWHERE_SETTINGS = Scattering(threshold=1.0)  # scattering that filters every pixel
FULL_SETTINGS = Scattering(threshold=1.0, steps=5)  # settings of preset "full"
LEVEL_SETTINGS = replace(FULL_SETTINGS, levels=3)  # full scattering at three levels of detail


def measure_scattering() -> dict[str, float]:
    """Measure speed and accuracy of adaptive skin scattering against full filtering.

    The effect is the colour difference in L*a*b* between no scattering and scattering everywhere. The kept effect is 1
    minus the adaptive picture's difference to scattering everywhere, relative to the effect, on all skin and where the
    effect is visible. With levels all skin is filtered, by more samples the more it is occluded (thesis Figures 5.2 and
    5.3).
    """
    none = _draw(None)[0]
    full, shared, _ = _draw(EVERYWHERE_SETTINGS)
    adaptive, filtered, skin = _draw(ADAPTIVE_SETTINGS)
    effect, missed = colour_difference(none, full)[skin], colour_difference(adaptive, full)[skin]
    is_visible = effect > VISIBLE_DIFFERENCE
    whole, levels = _draw(FULL_SETTINGS)[0], _draw(LEVEL_SETTINGS)[0]
    whole_effect, in_levels = colour_difference(none, whole)[skin], colour_difference(levels, whole)[skin]
    return {
        "face.scattering.ratio": _time_ratio(EVERYWHERE_SETTINGS, ADAPTIVE_SETTINGS),
        "face.scattering.filtered": 100.0 * filtered / shared,
        "face.scattering.kept": 100.0 * (1.0 - float(missed.sum() / effect.sum())),
        "face.scattering.kept_visible": 100.0 * (1.0 - float(missed[is_visible].sum() / effect[is_visible].sum())),
        "face.scattering.levels_ratio": _time_ratio(FULL_SETTINGS, LEVEL_SETTINGS),
        "face.scattering.levels_kept": 100.0 * (1.0 - float(in_levels.sum() / whole_effect.sum())),
    }


def _draw(settings: Scattering | None) -> tuple[Picture, float, Flags]:
    """Draw the head and return picture, filtered skin fraction and skin mask."""
    with Portrait(preset=_make_preset(settings)) as portrait:
        pixels, pipeline = portrait.draw(SMILE_UNITS), portrait.pipeline
        with pipeline.geometry.context:
            skin = pipeline.geometry.parts() == 1
            return pixels, pipeline.scatter.measure_filtered_fraction() if pipeline.scatter else 0.0, skin


def _time_ratio(whole: Scattering, part: Scattering) -> float:
    """Return the ratio of filter times with full and with cheaper settings.

    Both are timed in turn.
    """
    with Portrait(preset=_make_preset(whole)) as full, Portrait(preset=_make_preset(part)) as adaptive:
        scale = compute_pixel_scale(FRONT_CAMERA, full.size[1])
        clocks = [_clock(full), _clock(adaptive)]
        times: tuple[list[float], list[float]] = ([], [])
        for _ in range(TIMING_REPETITIONS):
            for portrait, clock, spent in zip((full, adaptive), clocks, times, strict=True):
                portrait.draw(SMILE_UNITS)
                pipeline = portrait.pipeline
                with clock.context:
                    _, bent = pipeline.relief.draw(compute_map_strengths(read_intensities(SMILE_UNITS)))
                    if pipeline.scatter:
                        spent.append(clock.milliseconds(partial(pipeline.scatter.draw, bent, scale)))
    return median(times[0]) / median(times[1])


def _clock(portrait: Portrait) -> DrawingClock:
    with portrait.pipeline.geometry.context as context:
        return DrawingClock(context)


def _make_preset(settings: Scattering | None) -> Preset:
    """Return the preset `normal` without edge smoothing, which would blur compared pixels."""
    return replace(NORMAL_PRESET, scattering=settings, smooth=False)

"""Exact or separable ambient occlusion on the G-buffer (thesis chapter 3).

Separable occlusion samples two directions instead of all. Directions vary from pixel to pixel in a small pattern, and a
geometry-aware blur combines neighbouring pixels: O(k) samples instead of O(k^2).
"""

from collections.abc import Callable, Mapping
from math import cos, pi, sin
from types import MappingProxyType
from typing import get_args

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.face.gl.context import GlContext
from kinesic.face.gl.textures import Size
from kinesic.face.render.geometry import PositionBuffer
from kinesic.face.render.passes import ScreenPass, Target, Value, make_texture
from kinesic.face.render.presets import Estimator, Falloff, Occlusion

PATTERN_SEED = 3  # seed of the random sample directions
GAUSSIAN_WIDTH = 0.27  # standard deviation of Gaussian occlusion / radius; equals Wendland's half-height width
UNOCCLUDED_COLOUR = (1.0, 0.0, 0.0, 0.0)  # occlusion value of the background: completely open


class OcclusionPass:
    """Pass that computes the unoccluded fraction of ambient light per pixel."""

    def __init__(self, context: GlContext, seen: PositionBuffer, occlusion: Occlusion) -> None:
        self.occlusion, self._seen = occlusion, seen
        estimator = get_args(Estimator).index(occlusion.estimator)

        def over_head(fragment: str, **defines: int) -> ScreenPass:
            target = Target(context, seen.position.size, ("4f4",), seen.depth)
            return ScreenPass(context, target, fragment, where=seen.where, defines=defines)

        falloff = get_args(Falloff).index(occlusion.falloff)
        angles = np.zeros((1, 1)) if occlusion.exact else make_direction_tile(occlusion, seen.position.size)
        wide, tall = angles.shape[1], angles.shape[0]
        defines = {"ESTIMATOR": estimator, "FALLOFF": falloff, "WIDE": wide, "TALL": tall}
        self.march = over_head("occlusion", **defines, DIRECTIONS=occlusion.directions, STEPS=occlusion.size // 2)
        self.blurs = () if occlusion.exact else tuple(over_head("blur", SIDE=occlusion.tile) for _ in range(2))
        self._pattern = make_texture(context, np.stack([np.cos(angles), np.sin(angles)], axis=-1), "f4")

    def draw(self, scale: float) -> Target:
        """Draw each pixel's unoccluded fraction 0..1 into the first colour component.

        The normals are those of the geometry, since the blur would smear wrinkles.

        Args:
            scale: [pixels/m] at the centre of the head.
        """
        occlusion, seen = self.occlusion, self._seen
        steps, turn = occlusion.size // 2, pi / occlusion.directions
        rings = np.arange(1, steps + 1)
        across, up = (1.0 / side for side in seen.position.size)
        values: dict[str, Value] = {
            "pixel": (across, up),
            "stride": occlusion.radius * scale / (steps + 1),
            "strength": occlusion.strength,
        }
        if occlusion.directions > 1:
            values["turn"] = cos(turn), sin(turn)
        plain = occlusion.estimator == "depth"  # the average of comparisons, without a falloff
        if not plain:
            values["radius"] = occlusion.radius
        if occlusion.estimator != "horizon":
            weights = 1.0 if plain else FALLOFF_FUNCTIONS[occlusion.falloff](rings / (steps + 1))
            values["all"] = float((rings * weights).sum())
        inputs = {"position": seen.position, "normal": seen.normal, "pattern": self._pattern}
        self.march.clear(*UNOCCLUDED_COLOUR)
        result = self.march.draw(inputs, values)
        for blur, axis in zip(self.blurs, ((across, 0.0), (0.0, up)), strict=False):
            blur.clear(*UNOCCLUDED_COLOUR)
            result = blur.draw({"noisy": result.textures[0]}, {"axis": axis})
        return result


def count_samples(occlusion: Occlusion) -> int:
    """Return the number of ambient-occlusion samples per pixel."""
    return 2 * (occlusion.size // 2) * occlusion.directions


def compute_wendland_weight(t: Floats) -> Floats:
    """Return the Wendland weight, falling from 1 to 0 (thesis 3.3.3).

    t is the distance / radius; the weight reaches 0 at t = 1.
    """
    return np.asarray(np.maximum(1.0 - t, 0.0) ** 4 * (4.0 * t + 1.0))


def compute_gaussian_weight(t: Floats) -> Floats:
    """Return a Gaussian weight as wide as Wendland's (thesis 3.3).

    It is cut off at 1, at a thousandth of its maximum.
    """
    return np.asarray(np.where(t < 1.0, np.exp(-0.5 * (t / GAUSSIAN_WIDTH) ** 2), 0.0))


FALLOFF_FUNCTIONS: Mapping[Falloff, Callable[[Floats], Floats]] = MappingProxyType(
    {"wendland": compute_wendland_weight, "gaussian": compute_gaussian_weight}
)


def make_direction_tile(occlusion: Occlusion, screen: Size) -> Floats:
    """Return each tile pixel's first sample direction [rad], shape (n, n).

    Noise has a tile as large as the screen. Directions cover half a turn for one axis, and a quarter of a turn if there
    is a second, perpendicular axis.
    """
    pattern, side = occlusion.pattern, occlusion.tile
    count = side * side
    random = np.random.default_rng(PATTERN_SEED)
    if pattern == "noise":
        return np.asarray(pi / occlusion.axes * random.uniform(size=screen[::-1]))
    if pattern == "random":
        fractions = random.uniform(size=count)
    elif pattern == "regular":
        fractions = np.arange(count) / count
    elif pattern == "jittered":
        fractions = (random.permutation(count) + random.uniform(size=count)) / count
    elif pattern == "halton":
        fractions = np.array([compute_radical_inverse(k + 1, 3) for k in range(count)])
    else:
        fractions = np.array([compute_radical_inverse(k, 2) for k in range(count)])
    return np.asarray(pi / occlusion.axes * fractions.reshape(side, side))


def compute_radical_inverse(number: int, base: int) -> float:
    """Return a number's radical inverse in a base (J. H. Halton, 1960)."""
    inverse, place = 0.0, 1.0 / base
    while number:
        number, digit = divmod(number, base)
        inverse += digit * place
        place /= base
    return inverse

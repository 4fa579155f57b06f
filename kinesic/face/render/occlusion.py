"""Ambient occlusion over the G-buffer, exact or separable (thesis chapter 3).

Separable occlusion marches along two directions instead of all. They turn from pixel to pixel in a small pattern, and a
blur that respects the geometry joins what neighbours saw: O(k) samples instead of O(k^2).
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
from kinesic.face.render.passes import ScreenPass, Target, Value, texture
from kinesic.face.render.presets import Estimator, Falloff, Occlusion

SEED = 3
SPREAD = 0.27  # of a Gaussian, as a share of the radius: at half its height as wide as Wendland's
OPEN = (1.0, 0.0, 0.0, 0.0)  # the backdrop


class OcclusionPass:
    """Finds how open each pixel of the head is."""

    def __init__(self, context: GlContext, seen: PositionBuffer, occlusion: Occlusion) -> None:
        self.occlusion, self._seen = occlusion, seen
        estimator = get_args(Estimator).index(occlusion.estimator)

        def over_head(fragment: str, **defines: int) -> ScreenPass:
            target = Target(context, seen.position.size, ("4f4",), seen.depth)
            return ScreenPass(context, target, fragment, where=seen.where, defines=defines)

        falloff = get_args(Falloff).index(occlusion.falloff)
        angles = np.zeros((1, 1)) if occlusion.exact else directions(occlusion, seen.position.size)
        wide, tall = angles.shape[1], angles.shape[0]
        defines = {"ESTIMATOR": estimator, "FALLOFF": falloff, "WIDE": wide, "TALL": tall}
        self.march = over_head("occlusion", **defines, DIRECTIONS=occlusion.directions, STEPS=occlusion.size // 2)
        self.blurs = () if occlusion.exact else tuple(over_head("blur", SIDE=occlusion.tile) for _ in range(2))
        self._pattern = texture(context, np.stack([np.cos(angles), np.sin(angles)], axis=-1), "f4")

    def draw(self, scale: float) -> Target:
        """Draws how open each pixel is, 0..1, in the first component.

        The normals are those of the geometry; wrinkles would be smeared by the blur.

        Args:
            scale: [pixels/m] at the middle of the head.
        """
        occlusion, seen = self.occlusion, self._seen
        steps, turn = occlusion.size // 2, pi / occlusion.directions
        rings = np.arange(1, steps + 1)
        across, up = (1.0 / side for side in seen.position.size)
        values: dict[str, Value] = {
            "pixel": (across, up),
            "stride": occlusion.radius * scale / (steps + 1),
            "radius": occlusion.radius,
            "strength": occlusion.strength,
        }
        if occlusion.directions > 1:
            values["turn"] = cos(turn), sin(turn)
        if occlusion.estimator != "horizon":
            values["all"] = float((rings * FALLOFFS[occlusion.falloff](rings / (steps + 1))).sum())
        inputs = {"position": seen.position, "normal": seen.normal, "pattern": self._pattern}
        self.march.clear(*OPEN)
        found = self.march.draw(inputs, values)
        for blur, axis in zip(self.blurs, ((across, 0.0), (0.0, up)), strict=False):
            blur.clear(*OPEN)
            found = blur.draw({"noisy": found.textures[0]}, {"axis": axis})
        return found


def samples(occlusion: Occlusion) -> int:
    """Counts the pixels that are looked at for one."""
    return 2 * (occlusion.size // 2) * occlusion.directions


def wendland(t: Floats) -> Floats:
    """Computes the Wendland weight, which falls from 1 at 0 to 0 at 1 and beyond (thesis 3.3.3)."""
    return np.asarray(np.maximum(1.0 - t, 0.0) ** 4 * (4.0 * t + 1.0))


def gaussian(t: Floats) -> Floats:
    """Computes a Gaussian weight as wide as Wendland's, cut off at 1, where a thousandth of it is left (thesis 3.3)."""
    return np.asarray(np.where(t < 1.0, np.exp(-0.5 * (t / SPREAD) ** 2), 0.0))


FALLOFFS: Mapping[Falloff, Callable[[Floats], Floats]] = MappingProxyType({"wendland": wendland, "gaussian": gaussian})


def directions(occlusion: Occlusion, screen: Size) -> Floats:
    """(n, n) [rad] the first direction at each pixel of a tile; of noise the tile is as large as the screen.

    They are of a half turn where there is one axis, and of a quarter where a second stands at right angles to it.
    """
    pattern, side = occlusion.pattern, occlusion.tile
    count = side * side
    random = np.random.default_rng(SEED)
    if pattern == "noise":
        return np.asarray(pi / occlusion.axes * random.uniform(size=screen[::-1]))
    if pattern == "random":
        shares = random.uniform(size=count)
    elif pattern == "regular":
        shares = np.arange(count) / count
    elif pattern == "jittered":
        shares = (random.permutation(count) + random.uniform(size=count)) / count
    elif pattern == "halton":
        shares = np.array([radical_inverse(k + 1, 3) for k in range(count)])
    else:
        shares = np.array([radical_inverse(k, 2) for k in range(count)])
    return np.asarray(pi / occlusion.axes * shares.reshape(side, side))


def radical_inverse(number: int, base: int) -> float:
    """Mirrors the digits of a number at the point (J. H. Halton, 1960)."""
    found, place = 0.0, 1.0 / base
    while number:
        number, digit = divmod(number, base)
        found += digit * place
        place /= base
    return found

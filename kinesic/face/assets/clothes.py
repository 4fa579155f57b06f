"""Cuts shirt, trousers and shoes out of one closed suit, per pixel.

A garment is the suit moved outward, and for each vertex how far it lies beyond the nearest hem, cuff or neckline:
drawing interpolates that number and leaves out what is beyond, so that borders are smooth whatever way faces run.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats

Colour = tuple[float, float, float]  # linear

SHIRT, TROUSERS, SHOES = (0.20, 0.30, 0.42), (0.07, 0.08, 0.10), (0.05, 0.04, 0.04)
MATT = 0.06  # how much cloth shines
LEATHER = 0.35
CUFF = 0.90  # of the forearm
CLOSE = 0.055  # [m] before cuffs and neckline, over which the shirt comes nearer to the skin
AT_CUFF, AT_NECK = 0.0085, 0.003  # [m] how much: the suit is wide there, and one would look into it
WAIST, HEM = 0.075, 0.0  # [m] up from the pelvis: where trousers begin, and the shirt ends
ANKLE = -0.735  # [m] where trousers end
NECKLINE = 0.45  # how steeply it falls forward
COLLAR = 0.008  # [m] that it lies over the joint of the neck
COVERED = 0.025  # [m] inside a border, from where nothing is seen of what is below


@dataclass(frozen=True, eq=False)
class Garment:
    """One piece of clothing, on all vertices of the suit."""

    colour: Colour
    gloss: float
    offset: Floats  # (v,) [m] outward from the suit
    beyond: Floats  # (v,) [m] past its nearest border; below 0 is cloth


def garments(points: Floats, centres: Mapping[str, Floats]) -> tuple[Garment, ...]:
    """Cuts the garments of a suit.

    Args:
        points: (v, 3) [m] of the suit.
        centres: segment -> (3,) [m] its joint.
    """
    up = points[:, 2] - centres["humanoid_root"][2]
    loose = np.clip((WAIST + 0.10 - up) / 0.17, 0.0, 1.0)  # the shirt hangs from the ribs
    wide = np.clip((-0.05 - up) / 0.5, 0.0, 1.0) * np.clip((up - ANKLE + 0.06) / 0.06, 0.0, 1.0)
    neckline, cuffs = below_neckline(points, centres), _past_cuffs(points, centres)
    tight = AT_CUFF * _before(cuffs) + AT_NECK * _before(neckline)
    return (
        Garment(SHIRT, MATT, 0.004 + 0.009 * loose - tight, np.maximum.reduce([neckline, cuffs, HEM - up])),
        Garment(TROUSERS, MATT, 0.001 + 0.008 * wide, np.maximum(up - WAIST, ANKLE - up)),
        Garment(SHOES, LEATHER, np.full(len(points), 0.003), up - ANKLE - 0.02),
    )


def _before(beyond: Floats) -> Floats:
    """(v,) 0 to 1 within `CLOSE` of a border, and 1 past it."""
    return np.asarray(np.clip(1.0 + beyond / CLOSE, 0.0, 1.0))


def below_neckline(points: Floats, centres: Mapping[str, Floats]) -> Floats:
    """(v,) [m] how far (v, 3) points lie over the neckline; below 0 is under the shirt."""
    away = points - centres["vt1"]
    return np.asarray((away[:, 2] + NECKLINE * away[:, 0] - COLLAR) / np.hypot(1.0, NECKLINE))


def _past_cuffs(points: Floats, centres: Mapping[str, Floats]) -> Floats:
    """(v,) [m] how far points lie beyond the nearer cuff."""
    found = np.full(len(points), -np.inf)
    for side in "lr":
        bone = centres[f"{side}_wrist"] - centres[f"{side}_elbow"]
        length = float(np.linalg.norm(bone))
        along = (points - centres[f"{side}_elbow"]) @ bone / length
        found = np.maximum(found, along - CUFF * length)
    return found

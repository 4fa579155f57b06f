"""Shirt, trousers and shoes: a body mesh moved outward, drawn within borders.

A garment is the suit moved outward, with the distance of each vertex beyond the nearest hem, cuff or neckline: drawing
interpolates this distance and omits pixels beyond the border, so borders are smooth for any face layout.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats

Colour = tuple[float, float, float]  # linear RGB

SHIRT_COLOUR = (0.20, 0.30, 0.42)  # linear RGB colour of the shirt
TROUSER_COLOUR = (0.07, 0.08, 0.10)  # linear RGB colour of the trousers
SHOE_COLOUR = (0.05, 0.04, 0.04)  # linear RGB colour of the shoes
CLOTH_GLOSS = 0.06  # specular strength of cloth
LEATHER_GLOSS = 0.35  # specular strength of leather
CUFF_POSITION = 0.90  # position of the cuff along the forearm, 0 elbow .. 1 wrist
TIGHTENING_RANGE = 0.055  # [m] distance from cuffs and neckline within which the shirt tightens
CUFF_TIGHTENING = 0.0085  # [m] distance by which the shirt is tightened at the cuffs, so that no gap shows
NECK_TIGHTENING = 0.003  # [m] distance by which the shirt is tightened at the neckline, so that no gap shows
WAIST_HEIGHT = 0.075  # [m] height of the top of the trousers above the pelvis
HEM_HEIGHT = 0.0  # [m] height of the shirt's lower hem above the pelvis
ANKLE_HEIGHT = -0.735  # [m] height of the lower end of the trousers above the pelvis
NECKLINE_SLOPE = 0.45  # descent of the neckline per forward distance [m/m]
COLLAR_HEIGHT = 0.008  # [m] height of the collar above the neck joint
COVERED_DEPTH = 0.018  # [m] depth below the neckline from which the head's skin is omitted


@dataclass(frozen=True, eq=False)
class Garment:
    """A garment's colour and gloss, with offset and border distance per vertex."""

    colour: Colour
    gloss: float
    offset: Floats  # (v,) [m] outward distance from the suit
    beyond: Floats  # (v,) [m] distance beyond the nearest border; negative inside the cloth


def cut_garments(points: Floats, centres: Mapping[str, Floats]) -> tuple[Garment, ...]:
    """Return shirt, trousers and shoes, made from a closed body suit.

    Args:
        points: (v, 3) [m] vertices of the suit.
        centres: segment -> (3,) [m] position of its joint.
    """
    up = points[:, 2] - centres["humanoid_root"][2]
    loose = np.clip((WAIST_HEIGHT + 0.10 - up) / 0.17, 0.0, 1.0)  # the shirt hangs from the ribs
    wide = np.clip((-0.05 - up) / 0.5, 0.0, 1.0) * np.clip((up - ANKLE_HEIGHT + 0.06) / 0.06, 0.0, 1.0)
    neckline, cuffs = measure_neckline_distance(points, centres), _measure_cuff_distance(points, centres)
    tight = CUFF_TIGHTENING * _ramp_to_border(cuffs) + NECK_TIGHTENING * _ramp_to_border(neckline)
    return (
        Garment(
            SHIRT_COLOUR,
            CLOTH_GLOSS,
            0.004 + 0.009 * loose - tight,
            np.maximum.reduce([neckline, cuffs, HEM_HEIGHT - up]),
        ),
        Garment(TROUSER_COLOUR, CLOTH_GLOSS, 0.001 + 0.008 * wide, np.maximum(up - WAIST_HEIGHT, ANKLE_HEIGHT - up)),
        Garment(SHOE_COLOUR, LEATHER_GLOSS, np.full(len(points), 0.003), up - ANKLE_HEIGHT - 0.02),
    )


def _ramp_to_border(beyond: Floats) -> Floats:
    """Return (v,) tightening factors: 1 at a garment's border, 0 inside."""
    return np.asarray(np.clip(1.0 + beyond / TIGHTENING_RANGE, 0.0, 1.0))


def measure_neckline_distance(points: Floats, centres: Mapping[str, Floats]) -> Floats:
    """Return the signed distance (v,) [m] of points from the neckline plane.

    It is positive above the sloping plane. The shirt covers points with a negative distance.
    """
    away = points - centres["vt1"]
    return np.asarray((away[:, 2] + NECKLINE_SLOPE * away[:, 0] - COLLAR_HEIGHT) / np.hypot(1.0, NECKLINE_SLOPE))


def _measure_cuff_distance(points: Floats, centres: Mapping[str, Floats]) -> Floats:
    """Return the (v,) distance of points beyond the nearer cuff [m]."""
    distance = np.full(len(points), -np.inf)
    for side in "lr":
        bone = centres[f"{side}_wrist"] - centres[f"{side}_elbow"]
        length = float(np.linalg.norm(bone))
        along = (points - centres[f"{side}_elbow"]) @ bone / length
        distance = np.maximum(distance, along - CUFF_POSITION * length)
    return distance

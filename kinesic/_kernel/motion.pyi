from collections.abc import Sequence

from kinesic.body.arrays import Flags, Floats
from kinesic.motion.bspline import Indices

# -- spline programs (module.cpp): n control points, m rows that are fixed, r rows of limits

def smooth(first: Indices, shares: Floats, values: Floats, form: Floats, pull: Floats) -> Floats: ...
def nearest(
    first: Indices,
    shares: Floats,
    values: Floats,
    form: Floats,
    pull: Floats,
    stencils: Floats,
    lower: Floats,
    upper: Floats,
) -> Floats | None: ...
def relax(
    first: Indices,
    shares: Floats,
    values: Floats,
    stencils: Floats,
    lower: Floats,
    upper: Floats,
    easy: float,
    target: float,
) -> tuple[Floats, float, Floats, Floats] | None: ...

# -- key times (key_time_simplex.h): r rows over m keys

def move_keys(shares: Floats, broken: Floats, late: Floats, early: Floats, penalties: Floats) -> Floats | None: ...

# -- motions of n hinges through m keys, over k pieces (free_motion.h); a rest is a knot, the own key before, an angle

Rest = tuple[int, int, float]

def free_motion(
    places: Floats,
    angles: Floats,
    keyed: Flags,
    firm: Flags,
    desired: Floats,
    limits: Floats,
    closeness: Floats,
    step: float,
    within: float,
    controls: Floats,
) -> list[tuple[float, int, Rest, Rest]]: ...

# -- motions: results of `sample` are written into the caller's arrays

def sample(
    controls: Floats, places: Floats, scales: Floats, angles: Floats, speeds: Floats, accelerations: Floats
) -> None: ...
def peaks(
    controls: Floats, scales: Floats, limits: Floats, shares: Sequence[Floats]
) -> tuple[Floats, Floats, Floats, float]: ...
def beyond(controls: Floats, before: Floats, scales: Floats, limits: Floats, full: float, flags: Flags) -> None: ...

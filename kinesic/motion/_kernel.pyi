from kinesic.body.arrays import Floats
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
    first: Indices, shares: Floats, values: Floats, stencils: Floats, lower: Floats, upper: Floats, easy: float
) -> tuple[Floats, float, Floats, Floats] | None: ...

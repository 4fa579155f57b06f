"""Changes every random input of the tests by about one part in 1e15: `KINESIC_NUDGE=7 make test`.

A test that hangs on the last bits of what it is given fails on some other processor, whose kernels round otherwise;
here it fails on this one. The number chooses which last bits are changed.
"""

import random
from functools import wraps

import numpy as np
from hypothesis import strategies as st

LAST_BITS = 2.2e-16
MOST = 4.5  # of them, either way: one part in 1e15
LARGE = 1e300  # what is larger stays, so that nothing overflows


def nudge(values, seed: int):
    """The same numbers some last bits away, each always by the same ones."""
    exact = np.atleast_1d(np.asarray(values, dtype=np.float64))  # a scalar's overflow would warn
    mixed = (exact.view(np.uint64) ^ np.uint64(seed)) * np.uint64(0x9E3779B97F4A7C15)
    steps = np.rint(MOST * ((mixed >> np.uint64(40)) / 2.0**23 - 1.0))
    away = exact + np.where(np.abs(exact) < LARGE, exact, 0.0) * (LAST_BITS * steps)
    return away if np.ndim(values) else float(away[0])


def nudged_generator(seed: int) -> type[np.random.Generator]:
    """A generator whose real numbers are some last bits away from those of NumPy's."""

    class Nudged(np.random.Generator):
        pass

    for name in ("uniform", "normal", "standard_normal", "random"):
        plain = getattr(np.random.Generator, name)

        def drawn(self, *args, plain=plain, **options):
            return nudge(plain(self, *args, **options), seed)

        setattr(Nudged, name, wraps(plain)(drawn))
    return Nudged


def nudge_random_inputs(seed: int) -> None:
    """Whoever draws random numbers from now on gets them some last bits away; to be called before any test is read."""
    plain_rng, plain_floats, plain_uniform = np.random.default_rng, st.floats, random.Random.uniform
    generator = nudged_generator(seed)

    def floats(min_value=None, max_value=None, **options):
        low = -np.inf if min_value is None else min_value
        high = np.inf if max_value is None else max_value
        drawn = plain_floats(min_value, max_value, **options)
        return drawn.map(lambda value: value if value != value else min(max(nudge(value, seed), low), high))

    np.random.default_rng = lambda seed=None: generator(plain_rng(seed).bit_generator)
    st.floats = floats
    random.Random.uniform = lambda self, a, b: nudge(plain_uniform(self, a, b), seed)

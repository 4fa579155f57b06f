"""Change of all random test inputs by about one part in 1e15.

`KINESIC_NUDGE=7 make test` finds tests that depend on the last bits of their input, and would fail on processors whose
kernels round differently. The number selects the changed bits.
"""

import random
from functools import wraps

import numpy as np
from hypothesis import strategies as st

MACHINE_EPSILON = 2.2e-16
MAX_NUDGE = 4.5  # largest change in units of `MACHINE_EPSILON`: one part in 1e15
MAX_NUDGED_VALUE = 1e300  # largest value that is changed, as larger ones could overflow


def nudge(values, seed: int):
    """Return the numbers with deterministic changes of some of their last bits."""
    exact = np.atleast_1d(np.asarray(values, dtype=np.float64))  # overflow of a scalar would warn
    mixed = (exact.view(np.uint64) ^ np.uint64(seed)) * np.uint64(0x9E3779B97F4A7C15)
    steps = np.rint(MAX_NUDGE * ((mixed >> np.uint64(40)) / 2.0**23 - 1.0))
    away = exact + np.where(np.abs(exact) < MAX_NUDGED_VALUE, exact, 0.0) * (MACHINE_EPSILON * steps)
    return away if np.ndim(values) else float(away[0])


def nudged_generator(seed: int) -> type[np.random.Generator]:
    """Return a generator whose real numbers differ from NumPy's in some last bits."""

    class Nudged(np.random.Generator):
        pass

    for name in ("uniform", "normal", "standard_normal", "random"):
        plain = getattr(np.random.Generator, name)

        def drawn(self, *args, plain=plain, **options):
            return nudge(plain(self, *args, **options), seed)

        setattr(Nudged, name, wraps(plain)(drawn))
    return Nudged


def nudge_random_inputs(seed: int) -> None:
    """Patch NumPy's random numbers, before tests are imported."""
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

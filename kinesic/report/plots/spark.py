"""Draws the duty of a servo in a cell of a table."""

import numpy as np
from markupsafe import Markup

from kinesic.report.checks.servos import FULL_DUTY, DriveLoad

BINS = 150
TALLEST = 1.25  # duty at the top
HEIGHT = 24


def spark(load: DriveLoad) -> Markup:
    """Draws the largest duty of each piece of time as an area, and a line at full duty."""
    edges = np.linspace(0, len(load.duties), min(BINS, len(load.duties)) + 1).astype(int)[:-1]
    tops = HEIGHT * (1 - np.minimum(np.maximum.reduceat(load.duties, edges), TALLEST) / TALLEST)
    points = "".join(f"L{k} {top:.3g}" for k, top in enumerate(tops))
    full = HEIGHT * (1 - FULL_DUTY / TALLEST)
    return Markup(
        f'<svg class="spark" viewBox="0 0 {max(len(tops) - 1, 1)} {HEIGHT}" preserveAspectRatio="none" '
        f'role="img" aria-label="duty over time"><path d="M0 {HEIGHT}{points}V{HEIGHT}Z"/>'
        f'<path class="full" d="M0 {full:.3g}H{len(tops)}"/></svg>'
    )

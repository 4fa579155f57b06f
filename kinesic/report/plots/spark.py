"""Small servo duty plot for a table cell."""

import numpy as np
from markupsafe import Markup

from kinesic.report.checks.servos import FULL_DUTY, DriveLoad

TIME_BINS = 150  # number of time bins in the servo duty plot
MAX_SHOWN_DUTY = 1.25  # duty (fraction of full PWM) at the top of the plot
CELL_HEIGHT = 24  # [SVG units] height of the servo duty plot


def spark(load: DriveLoad) -> Markup:
    """Draw a servo's peak duty over time, with the full-duty line."""
    edges = np.linspace(0, len(load.duties), min(TIME_BINS, len(load.duties)) + 1).astype(int)[:-1]
    tops = CELL_HEIGHT * (1 - np.minimum(np.maximum.reduceat(load.duties, edges), MAX_SHOWN_DUTY) / MAX_SHOWN_DUTY)
    points = "".join(f"L{k} {top:.3g}" for k, top in enumerate(tops))
    full = CELL_HEIGHT * (1 - FULL_DUTY / MAX_SHOWN_DUTY)
    return Markup(
        f'<svg class="spark" viewBox="0 0 {max(len(tops) - 1, 1)} {CELL_HEIGHT}" preserveAspectRatio="none" '
        f'role="img" aria-label="duty over time"><path d="M0 {CELL_HEIGHT}{points}V{CELL_HEIGHT}Z"/>'
        f'<path class="full" d="M0 {full:.3g}H{len(tops)}"/></svg>'
    )

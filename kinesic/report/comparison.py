"""How well one twin followed a plan, in few figures, so that twins can be put side by side."""

from dataclasses import dataclass

import numpy as np

from kinesic.controller.performance import Performance
from kinesic.report.checks.twin import stroke_errors, tracking_errors


@dataclass(frozen=True)
class Following:
    """Errors of tracking and of strokes; None where there is nothing to measure."""

    rmse_deg: float
    p95_deg: float
    max_deg: float
    strokes: int
    strokes_lost: int  # never reached
    stroke_median_s: float | None  # of the magnitude of the error to the asked time
    stroke_p95_s: float | None
    min_distance_m: float


def measure_tracking(performance: Performance) -> Following:
    """Measures one performance."""
    found, strokes = tracking_errors(performance), stroke_errors(performance)
    errors = [abs(error) for error, _ in strokes if error is not None]
    return Following(
        rmse_deg=found.rmse,
        p95_deg=found.p95,
        max_deg=found.max,
        strokes=len(strokes),
        strokes_lost=len(strokes) - len(errors),
        stroke_median_s=float(np.median(errors)) if errors else None,
        stroke_p95_s=float(np.percentile(errors, 95)) if errors else None,
        min_distance_m=float(performance.measured.clearance.distances.min()),
    )

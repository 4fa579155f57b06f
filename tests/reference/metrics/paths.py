"""Velocities, lengths and tracking errors of sampled paths in NumPy."""

import numpy as np

from kinesic.metrics.tracking_errors import TrackingErrors

SHORTEST_STEP = 1e-3  # [s] time steps below this duration get no velocity


def measure_stretch(times, path, begin: float, end: float) -> tuple[float, float]:
    """Return largest velocity and length of a section of a path."""
    first, last = times.searchsorted(begin, side="right"), times.searchsorted(end)
    places = np.stack([[np.interp(moment, times, column) for column in path.T] for moment in (begin, end)])
    steps = np.diff(np.concatenate([[begin], times[first:last], [end]]))
    ways = np.diff(np.concatenate([places[:1], path[first:last], places[1:]]), axis=0)
    distances = np.sqrt(np.vecdot(ways, ways))
    speeds = np.divide(distances, steps, out=np.zeros_like(steps), where=steps > SHORTEST_STEP)
    return float(speeds.max(initial=0.0)), float(distances.sum())


def measure_errors(errors, moving) -> TrackingErrors:
    """Compute the result of `tracking_errors.measure_errors`."""
    degrees, (rows, hinges) = np.degrees(np.abs(errors)), np.nonzero(moving)
    largest = int(degrees.argmax())
    return TrackingErrors(
        rmse=float(np.sqrt(np.mean(degrees**2))),
        p95=float(np.percentile(degrees, 95)),
        max=float(degrees.max()),
        row=int(rows[largest]),
        hinge=int(hinges[largest]),
        most=int(np.bincount(hinges, degrees**2).argmax()),
    )

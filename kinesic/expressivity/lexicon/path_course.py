"""Timing and hand orientation along captured paths."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats, sealed

ANCHOR_STRIDE = 4  # number of via points from one anchor of a captured path to the next


@dataclass(frozen=True, eq=False)
class PathCourse:
    """Captured timing and hand orientation along a path's via points."""

    duration: float  # [s] duration of the path in the capture
    parameters: Floats  # (p,) path parameters of the via points, between 0 and 1 and proportional to time
    pointing: Floats | None = None  # (p, 3) hand directions at the via points; None: interpolated between keys
    palm: Floats | None = None  # (p, 3) palm normals at the via points; None: interpolated between keys

    @property
    def knots(self) -> Floats:
        """Path parameters (p + 2,) of the via points and both ends."""
        return np.concatenate([[0.0], self.parameters, [1.0]])

    @property
    def anchors(self) -> Floats:
        """Path parameters of every fourth via point and of both ends."""
        return np.concatenate([[0.0], self.parameters[ANCHOR_STRIDE - 1 :: ANCHOR_STRIDE], [1.0]])

    def turned(self, turn: Callable[[Floats], Floats]) -> "PathCourse":
        """Return the course with every direction transformed by a function."""
        pointing, palm = (
            None if rows is None else sealed(np.array([turn(row) for row in rows]).reshape(-1, 3))
            for rows in (self.pointing, self.palm)
        )
        return replace(self, pointing=pointing, palm=palm)

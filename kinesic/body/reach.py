"""Position and orientation targets of a hand for inverse kinematics."""

import numpy as np
from msgspec import Struct

from kinesic.body.arrays import Floats


class Reach(Struct, frozen=True, eq=False):
    """Target of a hand: position, direction, palm normal and elbow swivel.

    The owner of a Reach defines the frame; `ik` expects the frame of the chain's base.
    """

    position: Floats  # (3,) [m] centre of the wrist
    pointing: Floats | None = None  # (3,) unit direction from the wrist along the hand
    palm: Floats | None = None  # (3,) unit normal of the palm
    swivel: float | None = None  # [rad] elbow rotation about the line shoulder-wrist; 0: hanging, +: away from the body

    def __post_init__(self) -> None:
        """Make the target's arrays read-only."""
        for values in (self.position, self.pointing, self.palm):
            if isinstance(values, np.ndarray):
                values.setflags(write=False)

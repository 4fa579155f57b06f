"""Where a hand should be and how it is held: what `expressivity` asks for and `ik` solves."""

from msgspec import Struct

from kinesic.body.arrays import Floats


class Reach(Struct, frozen=True, eq=False):
    """Where the hand (the wrist's centre) goes, and how it is held there.

    The frame of positions and directions is named by whoever holds the Reach; ik is asked in the frame of
    the chain's base.
    """

    position: Floats  # (3,) [m] of the wrist's centre
    pointing: Floats | None = None  # (3,) unit: direction from the wrist along the hand
    palm: Floats | None = None  # (3,) unit: direction that the palm faces
    swivel: float | None = None  # [rad] elbow about the line shoulder-wrist, 0 = hanging, + = away from the body

"""How a hand turns through its keys: Kochanek-Bartels splines on rotations.

Between two keys the logarithm of the rotation from the first is a cubic (Hermite), whose ends have the turning speeds
of the keys; these are weighted as those of positions are (sheet of the trajectory, 8.2). Speeds are the same before and
after each key, so that nothing jumps.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.motion.keys import Passage

SMALL = 1e-6  # [rad] turns that are none


@dataclass(frozen=True, eq=False)
class Turning:
    """A rotation as a function of time; constant before its first key and after its last."""

    times: Floats  # (k,) [s]
    keys: "scipy.spatial.transform.Rotation"  # k of them
    turns: "scipy.interpolate.PPoly"  # (3,) rotation vector from the key before, in that key's frame

    @classmethod
    def through(
        cls, times: Sequence[float], keys: "scipy.spatial.transform.Rotation", passages: Sequence[Passage]
    ) -> "Turning":
        """Through at least two keys, the short way from each to the next; at rest at both ends and in holds.

        Args:
            times: of the keys, increasing [s].
            keys: as many rotations.
            passages: as many, of which tension, continuity and bias count.
        """
        at = np.asarray(times, dtype=float)
        steps = np.diff(at)[:, None]
        ways = (keys[:-1].inv() * keys[1:]).as_rotvec()
        tension, continuity, bias = (
            np.array([[getattr(each, name)] for each in passages[1:-1]]).reshape(-1, 1)
            for name in ("tension", "continuity", "bias")
        )
        speeds = np.zeros((len(at), 3))
        earlier, later = ways[:-1] / steps[:-1] * steps[1:], ways[1:] / steps[1:] * steps[:-1]
        chords = (1 + bias) * earlier + (1 - bias) * later
        speeds[1:-1] = (1 - tension) * (1 + continuity) * chords / (steps[:-1] + steps[1:])
        still = np.linalg.norm(ways, axis=1) < SMALL
        speeds[:-1][still] = speeds[1:][still] = 0.0
        ends = np.einsum("kij,kj->ki", _inverse_jacobians(ways), speeds[1:])
        square = (3 * ways / steps - 2 * speeds[:-1] - ends) / steps
        cube = (speeds[:-1] + ends - 2 * ways / steps) / steps**2
        return cls(at, keys, scipy.interpolate.PPoly(np.stack([cube, square, speeds[:-1], np.zeros_like(ways)]), at))

    def at(self, times: Floats) -> "scipy.spatial.transform.Rotation":
        """The rotations at (m,) times [s]."""
        inside = np.clip(times, self.times[0], self.times[-1])
        way = np.clip(np.searchsorted(self.times, inside, side="right") - 1, 0, len(self.times) - 2)
        return self.keys[way] * scipy.spatial.transform.Rotation.from_rotvec(self.turns(inside))


def facing_rotations(pointing: Floats, palm: Floats) -> "scipy.spatial.transform.Rotation":
    """The rotations of hands from the directions (..., 3) in which they point and in which their palms face."""
    aside = np.cross(palm, pointing)
    aside /= np.linalg.norm(aside, axis=-1, keepdims=True)
    return scipy.spatial.transform.Rotation.from_matrix(np.stack([pointing, aside, np.cross(pointing, aside)], axis=-1))


def _inverse_jacobians(ways: Floats) -> Floats:
    """(k, 3, 3) from turning speeds in the body to the change of (k, 3) rotation vectors (right Jacobian, inverted)."""
    angles = np.maximum(np.linalg.norm(ways, axis=1), SMALL)[:, None, None]
    x, y, z = ways.T
    none = np.zeros_like(x)
    cross = np.stack([none, -z, y, z, none, -x, -y, x, none], axis=1).reshape(-1, 3, 3)
    bend = 1 / angles**2 - (1 + np.cos(angles)) / (2 * angles * np.sin(angles))
    return np.asarray(np.eye(3) + cross / 2 + bend * cross @ cross)

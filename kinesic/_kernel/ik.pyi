from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.ik.scalar3 import Rotation, Vector

Point = Sequence[float]  # three numbers [m], or a direction

# -- arms (bind_arm.cpp, bind_stages.cpp)

class Arm:
    def __init__(
        self,
        *,
        origin: Vector,
        counts: Sequence[int],
        bones: Sequence[Vector],
        axes: Sequence[Vector],
        lower: Sequence[float],
        upper: Sequence[float],
        rest: Sequence[float],
        mobility: Sequence[float],
        palm: Vector,
        side: float,
        farthest: float,
        closest: float,
        seeds: Sequence[Sequence[float]],
        mirrored: bool,
    ) -> None: ...
    def solve(
        self,
        position: Floats,
        pointing: Floats | None,
        palm: Floats | None,
        swivel: float | None,
        start: Floats,
        rest: Floats | None,
        mobility: Floats | None,
    ) -> tuple[Floats, float, float | None, float | None, bool, int, Floats, float] | None: ...
    def swing(
        self,
        position: Floats,
        pointing: Floats | None,
        palm: Floats | None,
        home: Floats,
        angles: Floats,
        widest: float,
    ) -> tuple[Floats, float, float | None, float | None]: ...
    def pose(
        self, position: Floats, rotation: Floats, start: Floats
    ) -> tuple[Floats, float, float, bool, int, int] | None: ...
    def hold(
        self, position: Floats, pointing: Floats | None, palm: Floats | None, start: Floats
    ) -> tuple[Floats, float, float, bool, int, int] | None: ...
    def pose_keys(
        self,
        modes: NDArray[np.int64],
        passing: NDArray[np.bool_],
        positions: Floats,
        pointings: Floats,
        palms: Floats,
        swivels: Floats,
        rests: Floats,
        openness: Floats,
        now: Floats,
        began: Floats,
        widest: float,
        leap: float,
        open: float,
        angles: Floats,
        beginnings: Floats,
        turns: Floats,
    ) -> None: ...
    def reach(self, target: Floats, angles: Floats) -> float: ...
    def reach_many(self, targets: Floats, start: Floats, rounds: int, angles: Floats, residuals: Floats) -> None: ...
    def solve_path(self, targets: Floats, swivels: Floats, start: Floats, settling: int, angles: Floats) -> None: ...
    def track(self, target: Floats, pull: float, parts: int, angles: Floats) -> float: ...
    def walk(self, angles: Sequence[float], links: int) -> tuple[list[float], list[list[float]]]: ...
    @staticmethod
    def settle(
        points: Sequence[Point], lengths: Sequence[float], target: Point
    ) -> tuple[list[list[float]], int, float]: ...
    @staticmethod
    def turn_towards(axis: Point, rest: Point, wanted: Point) -> float | None: ...
    @staticmethod
    def first_of_two(first: Point, second: Point, rest: Point, wanted: Point) -> list[float]: ...
    def extract(self, points: Sequence[Point], near: Sequence[float]) -> tuple[list[float], float]: ...
    def swivel_of(self, points: Sequence[Point]) -> float | None: ...
    def elbow_at(self, shoulder: Point, hand: Point, swivel: float) -> list[float]: ...
    def placed(
        self, target: Point, near: Sequence[float], rest: Sequence[float]
    ) -> tuple[list[list[float]], list[float], list[float], int]: ...
    def bent(
        self, ends: Sequence[Point], shoulder: Point, target: Point, near: Sequence[float], swivel: float | None
    ) -> tuple[list[float], bool, int]: ...
    def polish(
        self, target: Point, angles: Sequence[float], posture: Sequence[float], mobility: Sequence[float]
    ) -> tuple[list[float], float, int]: ...
    def nearest(self, target: Point) -> list[int]: ...
    def orient(
        self, frame: Rotation, own: Sequence[Point], wanted: Sequence[Point], rest: Sequence[float]
    ) -> list[float]: ...
    def gap(self, target: Point) -> float: ...
    def softened(self, target: Point) -> list[float]: ...

# -- both hands (bind_pair.cpp); left before right

Parts = Sequence[tuple[Vector, Sequence[tuple[int, Vector, Vector]]]]

class Pair:
    def __init__(
        self,
        *,
        lower: Sequence[float],
        upper: Sequence[float],
        torso: Sequence[int],
        length: float,
        arms: Sequence[Arm],
        joints: Sequence[Sequence[int]],
        bases: Sequence[Parts],
        hands: Sequence[Parts],
    ) -> None: ...
    def reach(
        self, left: Floats, right: Floats, start: Floats, torso_weight: float, first: int
    ) -> tuple[Floats, float, float, float, int]: ...

# -- ball chains (bind_chains.cpp); arrays are contiguous, results are written into the caller's

def chain_methods() -> list[str]: ...
def solve_chain(
    method: str, rest: Floats, target: Floats, out: Floats, rotations: Floats, tolerance: float, most: int
) -> tuple[int, float]: ...
def run_chain(
    method: str,
    rest: Floats,
    targets: Floats,
    tolerance: float,
    most: int,
    iterations: NDArray[np.int64],
    residuals: Floats,
    nanoseconds: Floats,
) -> None: ...

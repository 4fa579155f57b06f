from collections.abc import Sequence

from kinesic.body.arrays import Flags, Floats, Indices

# Arrays are contiguous; results are written into the caller's.

class MotionFrames:
    def __init__(self) -> None: ...
    def add_link(self, parent: int, origin: Floats, joints: Sequence[int], axes: Floats, offsets: Floats) -> None: ...
    def solve(self, chosen: Flags, sines: Floats, cosines: Floats, rotations: Floats, origins: Floats) -> None: ...

class CapsulePairs:
    def closest(self, rotations: Floats, origins: Floats, lowest: Floats) -> None: ...
    def gaps(self, rotations: Floats, origins: Floats, found: Floats) -> None: ...
    def nearest(
        self, frames: MotionFrames, chosen: Flags, sines: Floats, cosines: Floats, distances: Floats, pairs: Indices
    ) -> None: ...
    def survey(
        self,
        frames: MotionFrames,
        chosen: Flags,
        sines: Floats,
        cosines: Floats,
        segments: Indices,
        lowest: Floats,
        origins: Floats,
    ) -> None: ...

class ImpactTree:
    def __init__(self) -> None: ...
    def add_link(
        self,
        parent: int,
        origin: Floats,
        body: Floats,
        joints: Sequence[int],
        axes: Floats,
        offsets: Floats,
        armatures: Floats,
        points: Floats,
    ) -> None: ...
    def survey(
        self,
        angles: Floats,
        velocities: Floats,
        inverse_masses: Floats,
        squared_scales: Floats,
        gate: float,
        ratios: Floats,
        points: Indices,
    ) -> None: ...
    def jacobians(self, angles: Floats, points: Indices, columns: Floats) -> None: ...

def make_pairs(
    owners: Indices,
    starts: Floats,
    ends: Floats,
    first: Indices,
    second: Indices,
    radii: Floats,
    halves: Floats,
    hulled: Flags,
) -> CapsulePairs: ...
def measure_bodies(
    begins: Indices,
    radii: Floats,
    first: Indices,
    second: Indices,
    starts: Floats,
    ends: Floats,
    postures: Indices,
    near: Flags,
    gaps: Floats,
) -> None: ...
def suspect(angles: Floats, known: Indices, lowest: Floats, reaches: Floats, limit: float, near: Flags) -> None: ...
def inverse(
    before: Sequence[int],
    newton_euler: int,
    model: int,
    data: int,
    accelerating: bool,
    qpos: Floats,
    qvel: Floats,
    qacc: Floats,
    positions: Floats,
    speeds: Floats,
    accelerations: Floats,
    torques: Floats,
) -> None: ...
def keep_left(
    stages: Sequence[int],
    model: int,
    data: int,
    qpos: Floats,
    left: Floats,
    places: Indices,
    positions: Floats,
    kept: Floats,
) -> None: ...
def measure_drives(
    log: tuple[Floats, Floats, Floats, Floats, Floats],
    places: tuple[Indices, Indices, Indices, Indices, Indices],
    law: Floats,
    figures: Floats,
    left: Floats,
    first: int,
    found: tuple[Floats, Floats, Floats, Floats, Floats, Floats],
) -> None: ...

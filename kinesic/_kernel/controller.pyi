from collections.abc import Callable

from kinesic.body.arrays import Floats, Indices

class Observer: ...
class Correction: ...
class TwinPhysics: ...

def make_observer(
    forecast: Floats, gain: Floats, step: Floats, full: Floats, arrival: Floats, constants: Floats
) -> Observer: ...
def advance(observer: Observer, inputs: Floats, deviation: Floats, belief: Floats) -> None: ...
def make_correction(observer: Observer, lower: Floats, upper: Floats, constants: Floats) -> Correction: ...
def make_physics(
    step: int,
    model: int,
    data: int,
    clock: int,
    timestep: int,
    positions: Floats,
    speeds: Floats,
    control: Floats,
    hinges: Indices,
    play: Indices,
    actuators: Indices,
    ticks: Floats,
    longest: float,
    latency: float,
) -> TwinPhysics: ...
def split_steps(
    twin: TwinPhysics,
    before: Indices,
    after: Indices,
    lower: Floats,
    upper: Floats,
    begins: Indices,
    ends: Indices,
    columns: Indices,
    positions: Floats,
    factor: Floats,
    inverse_d: Floats,
    softness: Floats,
    matrix: Floats,
) -> None: ...
def perform(
    twin: TwinPhysics,
    times: Floats,
    led: tuple[Floats, Floats, Floats, Floats],
    correction: Correction | None,
    progress: Callable[[int], None],
    every: int,
) -> tuple[Floats, Floats, Floats, Indices, Indices, Floats]: ...

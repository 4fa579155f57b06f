"""Procedures that switch torque on and off over several cycles.

Each is a generator: it yields the goals of its servos for the next cycle, receives the snapshot of that cycle, and
returns when it is done. Other servos need not wait for it.
"""

from collections.abc import Generator, Sequence
from math import ceil

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.hardware.protocol.registers import WATCHDOG_UNIT, Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Axes, Snapshot, fold_turns
from kinesic.hardware.supervisor.goal_limits import MAX_LEAD_RATIO

STEP_CYCLES = 25  # cycles after which a servo counts as not reacting to a command
REPEAT_CYCLES = 5  # Cycles between repeated commands to switch torque on
MAX_SETTLING_CYCLES = 200  # largest number of cycles for servos to come to rest, or to take commands
STILL_TOLERANCE = 1.0  # [ticks] largest servo motion between reading its position and switching torque on
INITIAL_POWER = 0.1  # Initial PWM / PWM limit when torque is switched on
POWER_RAMP_TIME = 0.3  # [s] duration of the ramp from initial to full power

Procedure = Generator[Floats | None, Snapshot, None]  # goals [ticks] of its servos; None: unchanged


def watchdog_counts(seconds: float) -> int:
    """Convert a time [s] to counts of BUS_WATCHDOG, rounded up."""
    return ceil(seconds / WATCHDOG_UNIT - 1e-9)


def energise(
    axes: Axes, places: Sequence[int], first: Snapshot, power: Ticks, *, watchdog: int, steps: int
) -> Procedure:
    """Switch torque on at the current positions.

    The goal is set to the present position and read back, and power is ramped up.

    Args:
        axes: all servos.
        places: indices of the servos.
        first: last cycle.
        power: (m,) GOAL_PWM at full power.
        watchdog: value of BUS_WATCHDOG.
        steps: cycles until full power.

    Raises:
        BusError: a servo moves, does not take its goal, or gets no torque; then none of them has torque.
    """
    chosen = list(places)
    axes.put_all(Register.BUS_WATCHDOG, chosen, 0)
    _put_ram_values(axes, chosen)
    axes.put(Register.GOAL_PWM, {k: round(INITIAL_POWER * power[k]) for k in chosen})
    goals, since = fold_turns(first.positions[chosen]), first.time
    confirmed = False
    for _ in range(MAX_SETTLING_CYCLES):
        snapshot = yield goals
        here, since, before = fold_turns(snapshot.positions[chosen]), snapshot.time, since
        outdated = snapshot.times[chosen] < before - axes.poll_interval
        if outdated.any() or float(np.abs(here - goals).max(initial=0.0)) > STILL_TOLERANCE:
            goals, confirmed = here, False
        elif confirmed:
            break
        else:
            confirmed = all(_has_taken(axes, k, goal) for k, goal in zip(chosen, goals, strict=True))
            if not confirmed:
                _put_ram_values(axes, chosen)
    else:
        names = ", ".join(axes.label(k) for k in chosen)
        raise BusError(f"{names}: some of them move or do not take their goals; torque stays off")
    axes.put_all(Register.BUS_WATCHDOG, chosen, watchdog)
    yield from _switch_on(axes, chosen, goals)
    for power_ratio in np.linspace(INITIAL_POWER, 1.0, steps + 1)[1:].tolist():
        axes.put(Register.GOAL_PWM, {k: round(power_ratio * power[k]) for k in chosen})
        yield goals


def _switch_on(axes: Axes, chosen: list[int], goals: Floats) -> Procedure:
    """Switch torque on for all given servos, or for none.

    The command is repeated for servos that may have missed it and have not moved since.
    """
    unpowered, denials, since = list(chosen), 0, axes.now()
    for cycle in range(MAX_SETTLING_CYCLES):
        if cycle % REPEAT_CYCLES == 0:
            axes.put_all(Register.TORQUE_ENABLE, unpowered, 1)
        snapshot = yield goals
        waiting = ~snapshot.torque[chosen]
        if not waiting.any():
            return
        denials += bool((waiting & (snapshot.times[chosen] > since)).any())  # a late host may have received no records
        if denials == STEP_CYCLES:
            break
        still = np.abs(fold_turns(snapshot.positions[chosen]) - goals) <= STILL_TOLERANCE
        unpowered, since = [chosen[k] for k in np.flatnonzero(waiting & still)], snapshot.time
    where = axes.label(chosen[int(np.flatnonzero(waiting)[0])])
    axes.put_all(Register.TORQUE_ENABLE, chosen, 0)
    yield goals
    raise BusError(f"{where}: torque does not come on; has it shut down?")


def adopt(axes: Axes, first: Snapshot, earlier: Floats, power: Ticks, *, watchdog: int) -> Procedure:
    """Take over servos with torque at their positions, without dropping torque.

    Args:
        axes: all servos.
        first: last cycle.
        earlier: (m,) [ticks] their goals; stopped servos get their position as goal.
        power: (m,) GOAL_PWM at full power.
        watchdog: value of BUS_WATCHDOG.

    Raises:
        BusError: a servo does not take its watchdog, gains or profile.
    """
    snapshot = first
    for _ in range(STEP_CYCLES):
        if snapshot.recent.all():
            break
        snapshot = yield None
    away = (
        snapshot.tripped
        | ~snapshot.torque
        | (np.abs(earlier - snapshot.positions) > MAX_LEAD_RATIO * axes.manifest.full)
    )
    goals = np.clip(np.where(away, snapshot.positions, earlier), *axes.manifest.spans)
    chosen = np.flatnonzero(snapshot.torque & snapshot.recent).tolist()
    axes.put_all(Register.BUS_WATCHDOG, chosen, 0)  # clears a tripped watchdog, so that the servo takes goals again
    yield goals
    _put_ram_values(axes, chosen)
    axes.put(Register.GOAL_PWM, {k: int(power[k]) for k in chosen})
    watched = [k for k in chosen if axes.manifest.members[k].model.has(Register.BUS_WATCHDOG)]
    late, denials, since = watched, 0, axes.now()
    for _ in range(MAX_SETTLING_CYCLES):
        axes.put_all(Register.BUS_WATCHDOG, late, 0)
        axes.put_all(Register.BUS_WATCHDOG, late, watchdog)
        snapshot = yield goals
        late = [k for k in late if snapshot.records["watchdog"][k] != watchdog and snapshot.torque[k]]
        denials += bool((snapshot.times[late] > since).any())  # a late host may have received no records
        since = snapshot.time
        if not late or denials == STEP_CYCLES:
            break
    if late:
        raise BusError(f"{axes.label(late[0])}: its bus watchdog does not come on")
    for k in chosen:  # one servo per cycle, because all have torque
        for _ in range(STEP_CYCLES):
            if _has_taken(axes, k) or not snapshot.torque[k]:
                break
            _put_ram_values(axes, [k])
            snapshot = yield goals
        else:
            raise BusError(f"{axes.label(k)}: does not take its gains and profile")
        snapshot = yield goals


def release_torque(axes: Axes, *, tries: int) -> Procedure:
    """Switch torque off on every servo, and verify it.

    A silent servo does not delay the others.

    Args:
        axes: all servos.
        tries: cycles to wait for silent servos.

    Raises:
        BusError: some servos may still have torque.
    """
    gone, since = np.zeros(len(axes.all_places), dtype=np.bool_), axes.now()
    for _ in range(tries):
        remaining = [k for k in axes.all_places if not gone[k]]
        for _ in range(2):
            axes.put_all(Register.TORQUE_ENABLE, remaining, 0)
        axes.put_all(Register.BUS_WATCHDOG, remaining, 0)
        snapshot = yield None
        gone |= (snapshot.times >= since) & ~snapshot.torque
        if gone.all():
            return
    names = ", ".join(axes.label(k) for k in axes.all_places if not gone[k])
    raise BusError(f"{names}: may still have torque; switch the power off")


def keep_watchdogs(axes: Axes, snapshot: Snapshot, watchdog: int) -> None:
    """Restore BUS_WATCHDOG of servos with torque.

    A watchdog that has stopped its servo is left alone.
    """
    watchdogs = snapshot.records["watchdog"]
    axes.put_all(
        Register.BUS_WATCHDOG,
        np.flatnonzero(snapshot.torque & (watchdogs > 0) & (watchdogs != watchdog)).tolist(),
        watchdog,
    )


def _put_ram_values(axes: Axes, places: Sequence[int]) -> None:
    """Queue the required RAM values of some servos.

    Servos of different families have different registers.
    """
    chosen = {k: axes.manifest.members[k].ram_values for k in places}
    for register in dict.fromkeys(register for values in chosen.values() for register in values):
        axes.put(register, {k: values[register] for k, values in chosen.items() if register in values})


def _has_taken(axes: Axes, place: int, goal: float | None = None) -> bool:
    """Return whether a servo has stored its required RAM values and goal."""
    required = {**axes.manifest.members[place].ram_values}
    if goal is not None:
        required[Register.GOAL_POSITION] = axes.manifest.members[place].model.quantise(
            Register.GOAL_POSITION, round(goal)
        )
    try:
        return axes.read(place, required) == required
    except BusError:
        return False

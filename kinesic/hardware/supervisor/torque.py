"""Gives and takes torque by procedures that live through cycles, so that nothing else has to wait for them.

Each is a generator: it yields the goals of its servos for the next cycle, gets the snapshot of that cycle, and returns
when it is done.
"""

from collections.abc import Generator, Sequence
from math import ceil

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.hardware.protocol.registers import WATCHDOG, Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Axes, Snapshot, fold_turns
from kinesic.hardware.supervisor.goal_limits import LEAD

TRIES = 25  # cycles that a step may take
AGAIN = 5  # cycles after which torque is asked for once more
SETTLING = 200  # cycles in which limp servos must come to stand still
STILL = 1.0  # [ticks] that a limp servo may have moved between reading and torque
LOW = 0.1  # share of the PWM limit that torque begins with
RAMP = 0.3  # [s] until it has all of it

Procedure = Generator[Floats | None, Snapshot, None]  # goals [ticks] of its servos; None: as they are


def watchdog_counts(seconds: float) -> int:
    """Converts a time [s] to BUS_WATCHDOG."""
    return ceil(seconds / WATCHDOG - 1e-9)


def energise(
    axes: Axes, places: Sequence[int], first: Snapshot, power: Ticks, *, watchdog: int, steps: int
) -> Procedure:
    """Gives torque to limp servos where they are: goal = present, read back, low power first.

    Args:
        axes: all servos.
        places: who is armed.
        first: the last cycle.
        power: (m,) GOAL_PWM of full power.
        watchdog: BUS_WATCHDOG.
        steps: cycles until all power is there.

    Raises:
        BusError: a servo does not keep still, does not take its goal, or its torque does not come; none of them has
            torque then.
    """
    chosen = list(places)
    axes.put_all(Register.BUS_WATCHDOG, chosen, 0)
    _put_passing(axes, chosen)
    axes.put(Register.GOAL_PWM, {k: round(LOW * power[k]) for k in chosen})
    goals, since = fold_turns(first.positions[chosen]), first.time
    confirmed = False
    for _ in range(SETTLING):
        snapshot = yield goals
        here, since, before = fold_turns(snapshot.positions[chosen]), snapshot.time, since
        if (snapshot.times[chosen] < before).any() or float(np.abs(here - goals).max(initial=0.0)) > STILL:
            goals, confirmed = here, False
        elif confirmed:
            break
        else:
            confirmed = all(_has_taken(axes, k, goal) for k, goal in zip(chosen, goals, strict=True))
            if not confirmed:
                _put_passing(axes, chosen)
    else:
        names = ", ".join(axes.where(k) for k in chosen)
        raise BusError(f"{names}: some of them move, or do not take their goals; they stay limp")
    axes.put_all(Register.BUS_WATCHDOG, chosen, watchdog)
    yield from _switch_on(axes, chosen, goals)
    for share in np.linspace(LOW, 1.0, steps + 1)[1:].tolist():
        axes.put(Register.GOAL_PWM, {k: round(share * power[k]) for k in chosen})
        yield goals


def _switch_on(axes: Axes, chosen: list[int], goals: Floats) -> Procedure:
    """Switches torque on, and asks again whoever may not have heard it and has not moved since; or none gets it."""
    dark, denials, since = list(chosen), 0, axes.now()
    for cycle in range(SETTLING):
        if cycle % AGAIN == 0:
            axes.put_all(Register.TORQUE_ENABLE, dark, 1)
        snapshot = yield goals
        waiting = ~snapshot.torque[chosen]
        if not waiting.any():
            return
        denials += bool((waiting & (snapshot.times[chosen] > since)).any())  # a late host may have heard nobody
        if denials == TRIES:
            break
        still = np.abs(fold_turns(snapshot.positions[chosen]) - goals) <= STILL
        dark, since = [chosen[k] for k in np.flatnonzero(waiting & still)], snapshot.time
    where = axes.where(chosen[int(np.flatnonzero(waiting)[0])])
    axes.put_all(Register.TORQUE_ENABLE, chosen, 0)
    yield goals
    raise BusError(f"{where}: torque does not come on; has it shut down?")


def adopt(axes: Axes, first: Snapshot, earlier: Floats, power: Ticks, *, watchdog: int) -> Procedure:
    """Takes servos over that have torque, where they are, without dropping it.

    Args:
        axes: all servos.
        first: the last cycle.
        earlier: (m,) [ticks] goals that they had; those who were stopped get the place where they stopped.
        power: (m,) GOAL_PWM of full power.
        watchdog: BUS_WATCHDOG.

    Raises:
        BusError: a servo does not let itself be adopted.
    """
    snapshot = first
    for _ in range(TRIES):
        if snapshot.recent.all():
            break
        snapshot = yield None
    away = snapshot.tripped | ~snapshot.torque | (np.abs(earlier - snapshot.positions) > LEAD * axes.manifest.full)
    goals = np.clip(np.where(away, snapshot.positions, earlier), *axes.manifest.spans)
    chosen = np.flatnonzero(snapshot.torque & snapshot.recent).tolist()
    axes.put_all(Register.BUS_WATCHDOG, chosen, 0)  # a servo that was stopped takes goals again
    yield goals
    _put_passing(axes, chosen)
    axes.put(Register.GOAL_PWM, {k: int(power[k]) for k in chosen})
    late, denials, since = chosen, 0, axes.now()
    for _ in range(SETTLING):
        axes.put_all(Register.BUS_WATCHDOG, late, 0)
        axes.put_all(Register.BUS_WATCHDOG, late, watchdog)
        snapshot = yield goals
        late = [k for k in late if snapshot.records["watchdog"][k] != watchdog and snapshot.torque[k]]
        denials += bool((snapshot.times[late] > since).any())  # a late host may have heard nobody
        since = snapshot.time
        if not late or denials == TRIES:
            break
    if late:
        raise BusError(f"{axes.where(late[0])}: its bus watchdog does not come on")
    for k in chosen:  # one a cycle, as all have torque
        for _ in range(TRIES):
            if _has_taken(axes, k) or not snapshot.torque[k]:
                break
            _put_passing(axes, [k])
            snapshot = yield goals
        else:
            raise BusError(f"{axes.where(k)}: does not take its gains and profile")
        snapshot = yield goals


def release_torque(axes: Axes, *, tries: int) -> Procedure:
    """Takes the torque of every servo, and checks that it is gone; no servo is left out because of another.

    Args:
        axes: all servos.
        tries: cycles to wait for those who do not answer.

    Raises:
        BusError: it is not sure of some that they have no torque.
    """
    gone, since = np.zeros(len(axes.everybody), dtype=np.bool_), axes.now()
    for _ in range(tries):
        remaining = [k for k in axes.everybody if not gone[k]]
        for _ in range(2):
            axes.put_all(Register.TORQUE_ENABLE, remaining, 0)
        axes.put_all(Register.BUS_WATCHDOG, remaining, 0)
        snapshot = yield None
        gone |= (snapshot.times >= since) & ~snapshot.torque
        if gone.all():
            return
    names = ", ".join(axes.where(k) for k in axes.everybody if not gone[k])
    raise BusError(f"{names}: may still have torque; switch the power off")


def keep_watchdogs(axes: Axes, snapshot: Snapshot, watchdog: int) -> None:
    """Sets BUS_WATCHDOG of servos with torque where it is another; one that has stopped its servo stays."""
    told = snapshot.records["watchdog"]
    axes.put_all(
        Register.BUS_WATCHDOG, np.flatnonzero(snapshot.torque & (told > 0) & (told != watchdog)).tolist(), watchdog
    )


def _put_passing(axes: Axes, places: Sequence[int]) -> None:
    members = axes.manifest.members
    for register in members[places[0]].passing if places else ():
        axes.put(register, {k: members[k].passing[register] for k in places})


def _has_taken(axes: Axes, place: int, goal: float | None = None) -> bool:
    """Whether a servo holds what it must while it has torque, and a goal if one is given."""
    wishes = {**axes.manifest.members[place].passing}
    if goal is not None:
        wishes[Register.GOAL_POSITION] = round(goal)
    try:
        return axes.read(place, wishes) == wishes
    except BusError:
        return False

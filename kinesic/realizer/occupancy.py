"""Finds which hinges each behaviour occupies, and when."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from kinesic.bml.block import Action, Gaze, Gesture, Head, HeadDirectionShift, Pointing
from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.robot import SIDES, PartName, Robot
from kinesic.expressivity.behaviours import stays
from kinesic.expressivity.keyframes import HeldTurns
from kinesic.expressivity.turns import turn_angles
from kinesic.motion.trajectory import STEP
from kinesic.planning.plan import Plan
from kinesic.planning.torso import set_turn, torso_turn

Role = Literal["l_hand", "r_hand", "sign", "look", "trunk"]  # what only one behaviour at a time can do

ARMS: tuple[Role, ...] = ("l_hand", "r_hand")
FORTH = ("ready", "strokeStart", "stroke", "relax")  # the first of these that a behaviour has: it is where it should be
BACK = ("relax", "strokeEnd", "stroke", "end")  # from the first of these on it goes back
STILL = 1e-9  # [rad]


@dataclass(frozen=True, eq=False)
class Occupancy:
    """The hinges that one behaviour occupies, and when; times [s] on the clock of its motion."""

    behaviour: str
    roles: frozenset[Role]
    hinges: Flags  # (n,) that it moves
    begin: float  # it leaves
    ready: float  # it is where it must be
    relax: float  # it gives way to whatever comes
    end: float  # it is back, or stays
    offset: Floats | None = None  # (n,) [rad] from rest that it holds at its end, alone; None where it goes back

    @property
    def stays(self) -> bool:
        """Whether others of its kind return to where it ends."""
        return self.offset is not None

    def later(self, seconds: float) -> "Occupancy":
        """Shifts all its times by some seconds."""
        begin, ready, relax, end = (time + seconds for time in (self.begin, self.ready, self.relax, self.end))
        return replace(self, begin=begin, ready=ready, relax=relax, end=end)

    def holds(self, role: Role) -> bool:
        """Whether a role keeps the posture in which this behaviour ends."""
        return self.stays and role in self.roles

    def meets(self, other: "Occupancy") -> bool:
        """Whether both need the same part of the body at the same time."""
        return bool(self.roles & other.roles) and self.ready < other.relax and other.ready < self.relax


def occupancy_of(plan: Plan) -> tuple[Occupancy, ...]:
    """Finds what the moving behaviours of a plan occupy, in the order of their beginnings.

    Args:
        plan: whose own time counts.
    """
    zero, uses = plan.trajectory.zero, plan.keyframes.uses
    actions = {behaviour.id: behaviour.action for behaviour in plan.timeline.block.behaviours}
    times: dict[str, dict[str, float]] = {}
    for sync in plan.syncs:
        times.setdefault(sync.behaviour, {})[sync.sync] = sync.planned + zero
    found = [_behaviour_occupancy(id, actions[id], at, plan) for id, at in times.items() if uses.get(id)]
    return tuple(sorted(found, key=lambda each: (each.begin, each.behaviour)))


def freed_hinges(
    own: Sequence[Occupancy], moved: Flags, time: float, robot: Robot, *, others: Sequence[Occupancy] = ()
) -> Flags:
    """Finds the hinges (n,) that a block gives free when it is interrupted.

    Args:
        own: what its behaviours need.
        moved: (n,) hinges that it moves.
        time: [s] of the interruption.
        robot: whose arms count; of them those are free that the block holds then.
        others: what else the running motion does; a look that another one has taken over from is no longer there.
    """
    found = np.array(moved)
    for each in own:
        if each.stays and any(each.roles & other.roles and each.end < other.end for other in others if other.stays):
            found &= ~each.hinges
    for role in ARMS:
        if not any(role in each.roles and each.relax > time for each in own):
            found[list(arm_hinges(role, robot))] = False
    return found


def settle_occupancy(occupancy: Iterable[Occupancy]) -> tuple[Occupancy, ...]:
    """Keep the latest holding occupancy of each role.

    Its times stay, as a block that began earlier and ends later may hold something older.
    """
    last = {role: each for each in sorted(occupancy, key=lambda each: each.end) for role in each.roles if each.stays}
    return tuple(dict.fromkeys(last.values()))


def _behaviour_occupancy(id: str, action: Action, at: Mapping[str, float], plan: Plan) -> Occupancy:
    """One behaviour with sync points at times [s]."""
    parts, controls = plan.keyframes.uses[id], plan.trajectory.controls
    begin, end = min(at.values()), max(at.values())
    relax = end if stays(action) else next((at[name] for name in BACK if name in at), end)
    ready = min(next((at[name] for name in FORTH if name in at), end), relax)
    hinges = _hinges(parts, plan.setup.robot) & (np.ptp(controls, axis=0) > STILL)
    offset = None
    if stays(action):
        offset = sealed(_held(id, plan, controls[min(round(end / STEP), len(controls) - 3) + 1]))
        hinges = hinges | (np.abs(offset) > STILL)
    return Occupancy(id, _roles(action, parts), hinges, begin, ready, relax, end, offset)


def _held(id: str, plan: Plan, there: Floats) -> Floats:
    """Return the offset (n,) [rad] from rest that a behaviour holds alone.

    Args:
        id: of the behaviour.
        plan: of its block.
        there: (n,) [rad] posture at its end, which counts for the arms.
    """
    robot, controls, held = plan.setup.robot, plan.trajectory.controls, plan.keyframes.held
    trunk = [hinge for chain in ("torso", "neck") for hinge in robot.joints(chain)]
    last = {turns.kind: each for each, turns in held.items()}
    found = there - controls[0]
    found[trunk] = held_angles(held[id], robot)[trunk]
    if id == last.get("posture") or (id == last.get("look") and "posture" not in last):  # with a lean of the reaches
        look = held_angles(held[last["look"]], robot) if id != last.get("look") and "look" in last else 0.0
        found[trunk] = (controls[-1] - controls[0] - look)[trunk]
    used = _hinges(plan.keyframes.uses[id], robot)
    used[trunk] = True  # the neck turns back where the torso leans
    return np.where(used, found, 0.0)


def held_angles(turns: HeldTurns, robot: Robot) -> Floats:
    """Return the offset (n,) [rad] of torso and neck for two rotations."""
    angles = np.array(robot.skeleton.rest)
    set_turn(robot, "torso", np.array(turn_angles(turns.torso)), angles)
    above = np.array(turn_angles(turns.head)) - torso_turn(robot, "torso", angles)
    set_turn(robot, "neck", above, angles)
    return np.asarray(angles - robot.skeleton.rest)


def still_occupied(occupancy: Iterable[Occupancy], time: float) -> tuple[Occupancy, ...]:
    """Keep unrelaxed occupancies and held values at a time [s]."""
    every = tuple(occupancy)
    over = sorted((each for each in every if each.stays and each.relax <= time), key=lambda each: each.end)
    held = {role: each for each in over for role in each.roles}
    return tuple(each for each in every if each.relax > time or each in held.values())


def _hinges(parts: frozenset[PartName], robot: Robot) -> Flags:
    found = np.zeros(len(robot.skeleton.hinges), dtype=np.bool_)
    for part in parts:
        found[list(robot.part_joints(part))] = True
    return found


def _roles(action: Action, parts: frozenset[PartName]) -> frozenset[Role]:
    """The hands that a behaviour moves, and its part in what the trunk does: movements of different kinds add up."""
    roles: set[Role] = {role for role in ARMS if role in parts}
    match action:
        case Gesture() | Pointing():
            pass
        case Head():
            roles.add("sign")
        case Gaze() | HeadDirectionShift():
            roles.add("look")
        case _:
            roles |= {"trunk"} if parts - set(ARMS) else set()
    return frozenset(roles)


def arm_hinges(role: Role, robot: Robot) -> tuple[int, ...]:
    """Lists the hinges of a hand: those of its arm, then those of its fingers."""
    sides = {f"{side}_hand": robot.arm(side).moving for side in SIDES}
    return sides[role]


@dataclass(frozen=True)
class MergeFailure:
    """A behaviour that has no way within the limits."""

    behaviour: str
    why: str


@dataclass(frozen=True, eq=False)
class Overlay:
    """A block's motion and the running one over which it is laid, both from the same knot on."""

    base: Floats  # (k + 3, n) [rad] control points of what runs
    coming: Floats  # (k + 3, n) [rad] of the block's own motion
    start: Floats  # (n,) [rad] where that motion begins, which may be before the first of these
    cut: int  # knot until which nothing may change
    holding: Sequence[Occupancy]  # of what runs, what has not given way at the cut
    performed: Sequence[Occupancy]  # behaviours of the block
    dropped: Sequence[Occupancy]  # behaviours of the block that are left out

    def trunk_failure(self, why: str) -> MergeFailure:
        """Blames the last behaviour of the block that moves the trunk; none where it performs none."""
        performed = sorted(self.performed, key=lambda each: not each.roles <= set(ARMS))
        return MergeFailure(performed[-1].behaviour if performed else "", why)

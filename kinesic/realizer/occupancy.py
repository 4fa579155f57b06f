"""Hinges and roles (hands, gaze, trunk) that behaviours occupy over time."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cmp_to_key
from math import inf
from typing import Literal, TypeVar

import numpy as np

from kinesic.bml.block import Action, Gaze, Gesture, Head, HeadDirectionShift, Pointing
from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.robot import SIDES, PartName, Robot
from kinesic.expressivity.behaviours import stays
from kinesic.expressivity.keyframes import HeldTurns
from kinesic.expressivity.turns import rest_head_turn, rest_turn, turn_angles
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.planning.plan import Plan
from kinesic.planning.torso import compute_torso_turn, set_turn

Role = Literal["l_hand", "r_hand", "sign", "look", "trunk"]  # body function that one behaviour at a time may use

ARM_ROLES: tuple[Role, ...] = ("l_hand", "r_hand")  # roles of the arms
READY_SYNCS = ("ready", "strokeStart", "stroke", "relax")  # sync points that may set `ready` of `Occupancy`, best first
RELAX_SYNCS = ("relax", "strokeEnd", "stroke", "end")  # sync points that may set `relax` of `Occupancy`, best first
MOTION_TOLERANCE = 1e-9  # [rad] hinges that move less count as unmoved
ROUNDING_TOLERANCE = 1e-6  # [s] times closer than this count as equal, as clock shifts cause rounding errors

T = TypeVar("T")  # type of the entries to sort


@dataclass(frozen=True, eq=False)
class Occupancy:
    """Hinges and roles that one behaviour occupies, with the times.

    Times [s] on the clock of its motion.
    """

    behaviour: str
    roles: frozenset[Role]
    hinges: Flags  # (n,) hinges that the behaviour moves
    begin: float  # [s] start of the preparation
    ready: float  # [s] required posture reached
    relax: float  # [s] end of exclusive use
    end: float  # [s] end of the retraction, or of the change to a held posture
    offset: Floats | None = None  # (n,) [rad] held offset from rest; None: the behaviour returns to rest

    @property
    def is_held(self) -> bool:
        """Whether the behaviour holds its final posture."""
        return self.offset is not None

    def shifted(self, offset: float) -> "Occupancy":
        """Return the occupancy shifted by a time [s]."""
        begin, ready, relax, end = (time + offset for time in (self.begin, self.ready, self.relax, self.end))
        return replace(self, begin=begin, ready=ready, relax=relax, end=end)

    def holds(self, role: Role) -> bool:
        """Return whether the behaviour holds its final posture in a role."""
        return self.is_held and role in self.roles

    def conflicts_with(self, other: "Occupancy") -> bool:
        """Return whether two occupancies claim a role at the same time."""
        return bool(self.roles & other.roles) and self.ready < other.relax and other.ready < self.relax


def sort_by_time(entries: Iterable[T], times: Callable[[T], tuple[float, ...]]) -> list[T]:
    """Sort entries stably by times [s], treating rounding differences as equal.

    Times of blocks that were sent together differ by rounding, which must not decide whose posture is held.

    Args:
        entries: earlier sent ones first.
        times: returns the times of an entry, the most significant first.
    """

    def compare(first: T, second: T) -> int:
        pairs = zip(times(first), times(second), strict=True)
        return next((int(np.sign(a - b)) for a, b in pairs if abs(a - b) > ROUNDING_TOLERANCE), 0)

    return sorted(entries, key=cmp_to_key(compare))


def end_time(entry: Occupancy) -> tuple[float]:
    """Return the end [s] of an occupancy, to sort by it."""
    return (entry.end,)


def occupancy_of(plan: Plan) -> tuple[Occupancy, ...]:
    """Return the occupancies of a plan's moving behaviours, sorted by start time.

    Args:
        plan: plan, whose time is used.
    """
    zero, uses = plan.trajectory.zero, plan.keyframes.uses
    actions = {behaviour.id: behaviour.action for behaviour in plan.timeline.block.behaviours}
    times: dict[str, dict[str, float]] = {}
    for sync in plan.syncs:
        times.setdefault(sync.behaviour, {})[sync.sync] = sync.planned + zero
    occupancies = [_behaviour_occupancy(id, actions[id], at, plan) for id, at in times.items() if uses.get(id)]
    return tuple(sorted(occupancies, key=lambda entry: (entry.begin, entry.behaviour)))


def freed_hinges(
    block_occupancy: Sequence[Occupancy],
    moved: Flags,
    time: float,
    robot: Robot,
    *,
    others: Sequence[Occupancy] = (),
    longest_retraction: float = inf,
) -> Flags:
    """Return the hinges (n,) that an interrupted block releases.

    Args:
        block_occupancy: occupancies of its behaviours.
        moved: (n,) hinges that it moves.
        time: time [s] of the interruption.
        robot: robot; only arms that the block uses at that time are released.
        others: other occupancies of the running motion; a superseded look is not released.
        longest_retraction: remaining time [s] above which an arm that retracts is released, too.
    """
    hinges = np.array(moved)
    for entry in block_occupancy:
        if entry.is_held and any(
            entry.roles & other.roles and entry.end < other.end for other in others if other.is_held
        ):
            hinges &= ~entry.hinges
    for role in ARM_ROLES:
        ends = [max(entry.relax, entry.end - longest_retraction) for entry in block_occupancy if role in entry.roles]
        if ends and max(ends) <= time:  # an arm without a behaviour has idle motion alone
            hinges[list(arm_hinges(role, robot))] = False
    return hinges


def settle_occupancy(occupancy: Iterable[Occupancy]) -> tuple[Occupancy, ...]:
    """Keep only the last holding occupancy of each role.

    Its times stay, because a block that began earlier and ends later may hold an older value.
    """
    last = {role: entry for entry in sort_by_time(occupancy, end_time) for role in entry.roles if entry.is_held}
    return tuple(dict.fromkeys(last.values()))


def _behaviour_occupancy(id: str, action: Action, at: Mapping[str, float], plan: Plan) -> Occupancy:
    """Return the occupancy of a behaviour with sync points at times [s]."""
    parts, controls = plan.keyframes.uses[id], plan.trajectory.controls
    begin, end = min(at.values()), max(at.values())
    relax = end if stays(action) else next((at[name] for name in RELAX_SYNCS if name in at), end)
    ready = min(next((at[name] for name in READY_SYNCS if name in at), end), relax)
    hinges = _hinges(parts, plan.setup.robot) & (np.ptp(controls, axis=0) > MOTION_TOLERANCE)
    offset = None
    if stays(action):
        offset = sealed(_held(id, plan, controls[min(round(end / KNOT_INTERVAL), len(controls) - 3) + 1]))
        hinges = hinges | (np.abs(offset) > MOTION_TOLERANCE)
    return Occupancy(id, _roles(action, parts), hinges, begin, ready, relax, end, offset)


def _held(id: str, plan: Plan, there: Floats) -> Floats:
    """Return the offset (n,) [rad] from rest that a behaviour holds.

    Args:
        id: id of the behaviour.
        plan: plan of its block.
        there: (n,) [rad] posture at its end, used for the arms.
    """
    robot, controls, held = plan.setup.robot, plan.trajectory.controls, plan.keyframes.held
    trunk = [hinge for chain in ("torso", "neck") for hinge in robot.joints(chain)]
    last = {turns.kind: entry for entry, turns in held.items()}
    offset = there - controls[0]
    offset[trunk] = held_angles(held[id], robot)[trunk]
    if id == last.get("posture") or (id == last.get("look") and "posture" not in last):  # including the lean of reaches
        look = held_angles(held[last["look"]], robot) if id != last.get("look") and "look" in last else 0.0
        offset[trunk] = (controls[-1] - controls[0] - look)[trunk]
    used = _hinges(plan.keyframes.uses[id], robot)
    used[trunk] = True  # the neck compensates the lean of the torso
    return np.where(used, offset, 0.0)


def held_angles(turns: HeldTurns, robot: Robot) -> Floats:
    """Convert held torso and head rotations to hinge offsets from rest.

    The result is (n,) [rad] and 0 outside of torso and neck.
    """
    angles = np.array(robot.skeleton.rest)
    set_turn(robot, "torso", np.array(turn_angles(turns.torso)) + turn_angles(rest_turn(robot, "torso")), angles)
    head = np.array(turn_angles(turns.head)) + turn_angles(rest_head_turn(robot))
    above = head - compute_torso_turn(robot, "torso", angles)
    set_turn(robot, "neck", above, angles)
    return np.asarray(angles - robot.skeleton.rest)


def remaining_occupancy(occupancy: Iterable[Occupancy], time: float) -> tuple[Occupancy, ...]:
    """Return occupancies that relax after a time [s], and held postures.

    Of each role, the posture that ended last is held.
    """
    all_occupancies = tuple(occupancy)
    over = sort_by_time((entry for entry in all_occupancies if entry.is_held and entry.relax <= time), end_time)
    held = {role: entry for entry in over for role in entry.roles}
    return tuple(entry for entry in all_occupancies if entry.relax > time or entry in held.values())


def _hinges(parts: frozenset[PartName], robot: Robot) -> Flags:
    hinges = np.zeros(len(robot.skeleton.hinges), dtype=np.bool_)
    for part in parts:
        hinges[list(robot.part_joints(part))] = True
    return hinges


def _roles(action: Action, parts: frozenset[PartName]) -> frozenset[Role]:
    """Return the arms and trunk roles that a behaviour uses.

    Trunk movements of different roles add up.
    """
    roles: set[Role] = {role for role in ARM_ROLES if role in parts}
    match action:
        case Gesture() | Pointing():
            pass
        case Head():
            roles.add("sign")
        case Gaze() | HeadDirectionShift():
            roles.add("look")
        case _:
            roles |= {"trunk"} if parts - set(ARM_ROLES) else set()
    return frozenset(roles)


def arm_hinges(role: Role, robot: Robot) -> tuple[int, ...]:
    """Return the hinge indices of an arm, then those of its fingers."""
    sides = {f"{side}_hand": robot.arm(side).all_joints for side in SIDES}
    return sides[role]


@dataclass(frozen=True)
class MergeFailure:
    """Behaviour that cannot be merged within the limits, with the reason."""

    behaviour: str
    why: str


@dataclass(frozen=True, eq=False)
class Overlay:
    """Block motion and running motion, starting at the same knot."""

    base: Floats  # (k + 3, n) [rad] control points of the running motion
    coming: Floats  # (k + 3, n) [rad] control points of the block's motion
    start: Floats  # (n,) [rad] start of the block's motion, possibly before the first knot
    cut: int  # first knot that may change
    holding: Sequence[Occupancy]  # occupancies of the running motion after the cut
    performed: Sequence[Occupancy]  # behaviours of the block
    finishing: Sequence[Occupancy] = ()  # behaviours of the block that hands finish in the running motion

    def trunk_failure(self, why: str) -> MergeFailure:
        """Return a failure of the last behaviour with trunk motion, if any."""
        performed = sorted(self.performed, key=lambda entry: not entry.roles <= set(ARM_ROLES))
        return MergeFailure(performed[-1].behaviour if performed else "", why)

"""Scheduling of all sync points of a block.

Impossible behaviours are dropped.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from kinesic.bml.block import (
    Behaviour,
    Block,
    Drop,
    Notice,
    NoticeType,
    Precedence,
    Speech,
    Synchronize,
    SyncRef,
    TimedBehaviour,
    Timeline,
    document_error,
)
from kinesic.bml.timing.constraints import Equality, find_attribute_equalities, find_relax_equalities, get_point
from kinesic.bml.timing.negative_cycles import Edge, find_contradictions
from kinesic.bml.timing.network import MIN_BEHAVIOUR_DURATION, ExternalTimes, Network, ReferenceResolver
from kinesic.bml.timing.points import find_natural_spans
from kinesic.bml.timing.settle import solve_times
from kinesic.body.utterance import Utterance

Constraint = Synchronize | Precedence


def schedule(
    block: Block,
    utterances: Mapping[str, Utterance],
    spans: Mapping[str, Mapping[str, float]],
    *,
    external_times: ExternalTimes | None = None,
) -> Timeline:
    """Compute the times of all behaviours of a block.

    Equalities hold exactly, sync points of a behaviour never go backwards, `after` and `before` hold; within this,
    phases are as close to their natural durations as possible (strokes first). A behaviour without feasible times is
    dropped. A behaviour that refers to a dropped one keeps its other references; if none is left it is dropped as well,
    unless it is a speech, which is then unconstrained. Behaviours of other agents are timed, since other behaviours may
    refer to them, and then skipped.

    Args:
        block: block to schedule.
        utterances: utterance by speech id.
        spans: behaviour id -> {sync point: natural duration [s] from the previous point}; defaults apply if missing.
        external_times: (block, behaviour, sync point) of other blocks -> time [s] of this block.

    Returns:
        The behaviours in document order with all their times, the dropped behaviours, and the notices.

    Raises:
        BmlError: a required part cannot be timed, or a time is beyond the block's `max_duration`.
    """
    active = _ActiveSet.of(block)
    for behaviour in block.behaviours:
        if isinstance(behaviour.action, Speech) and behaviour.id not in utterances:
            active.drop(behaviour.id, NoticeType.CANNOT_CREATE_BEHAVIOR, "no voice speaks its text")
    while True:
        resolver = ReferenceResolver(block, active.behaviours, utterances, external_times or {}, spans)
        network = resolver.build_network(active.find_equalities(), active.constraints)
        for unresolved in resolver.unresolved:
            active.remove(unresolved.culprit, unresolved.kind, unresolved.reason, unresolved.sync)
        if resolver.unresolved:
            continue
        loops = network.find_order_conflicts() or find_contradictions(network.edges())
        active.resolve(loops)
        if not loops:
            return _build_timeline(active, network, spans)


@dataclass
class _ActiveSet:
    """Behaviours and constraints still to schedule, and dropped behaviours."""

    block: Block
    behaviours: dict[str, Behaviour]
    constraints: list[Constraint]
    dropped: list[Drop] = field(default_factory=list)
    notices: list[Notice] = field(default_factory=list)

    @classmethod
    def of(cls, block: Block) -> "_ActiveSet":
        return cls(block, {b.id: b for b in block.behaviours}, list(block.constraints), [], list(block.notices))

    def find_equalities(self) -> list[Equality]:
        """Return equality constraints from sync attributes and from BML's defaults."""
        constrained_points = {get_point(ref) for constraint in self.constraints for ref in _list_refs(constraint)}
        equalities: list[Equality] = []
        for behaviour in self.behaviours.values():
            equalities += find_attribute_equalities(behaviour, self.block.id)
            equalities += find_relax_equalities(behaviour, self.block.id, constrained_points)
        return equalities

    def add_notice(self, kind: NoticeType, text: str, behaviour: str | None = None) -> None:
        self.notices.append(Notice(kind, ":".join(filter(None, (self.block.id, behaviour))), text))

    def remove(self, culprit: str | Constraint, kind: NoticeType, reason: str, sync: str = "") -> None:
        """Drop a behaviour or ignore a constraint.

        A speech is kept without the failing sync point, unless this is its start.

        Raises:
            BmlError: the behaviour or the constraint is required.
        """
        if isinstance(culprit, str):
            behaviour = self.behaviours.get(culprit)
            if behaviour is not None and not self._release_speech_time(behaviour, sync, reason):
                self.drop(culprit, kind, reason)
        elif culprit in self.constraints:
            if culprit.required:
                raise document_error(
                    self.block.source, culprit.place, f"a required constraint fails: {reason}", _REQUIRED_REMEDY
                )
            self.constraints.remove(culprit)
            self.add_notice(kind, f"a constraint (line {culprit.place.line}) is ignored: {reason}")

    def drop(self, name: str, kind: NoticeType, reason: str) -> None:
        """Drop a behaviour, and behaviours that depend on this behaviour alone.

        Raises:
            BmlError: one of them is required.
        """
        pending = [(name, kind, reason)]
        for dropped_id, kind, reason in pending:  # the list grows during the iteration
            behaviour = self.behaviours.pop(dropped_id, None)
            if behaviour is None:
                continue
            if behaviour.required:
                problem = f"the required {behaviour.type} '{dropped_id}' cannot be performed: {reason}"
                raise document_error(self.block.source, behaviour.place, problem, _REQUIRED_REMEDY)
            self.dropped.append(Drop(behaviour, reason))
            self.add_notice(kind, f"{behaviour.type} '{dropped_id}' is dropped: {reason}", dropped_id)
            self.constraints = [
                remaining for old in self.constraints for remaining in self._remove_from_constraint(old, dropped_id)
            ]
            for other in list(self.behaviours.values()):
                if any(self._refers_to(ref, dropped_id) for ref in _list_refs(other)) and not self._remove_references(
                    other, dropped_id
                ):
                    cause = f"its times refer to '{dropped_id}', which is dropped"
                    pending.append((other.id, NoticeType.IMPOSSIBLE_TO_SCHEDULE, cause))

    def skip(self, behaviour: Behaviour, agent: str) -> None:
        """Skip a behaviour of another agent.

        Its times remain valid for references.
        """
        reason = f"{agent} performs it"
        self.dropped.append(Drop(behaviour, reason))
        self.add_notice(
            NoticeType.CANNOT_CREATE_BEHAVIOR, f"{behaviour.type} '{behaviour.id}' is skipped: {reason}", behaviour.id
        )

    def _refers_to(self, ref: SyncRef, name: str) -> bool:
        return (ref.block, ref.behaviour) == (self.block.id, name)

    def _remove_references(self, behaviour: Behaviour, dropped_id: str) -> bool:
        """Remove the references to a dropped behaviour.

        Returns:
            False if the behaviour would keep no reference and must be dropped.
        """
        remaining = {sync: ref for sync, ref in behaviour.syncs.items() if not self._refers_to(ref, dropped_id)}
        in_constraints = any(self._refers_to(ref, behaviour.id) for c in self.constraints for ref in _list_refs(c))
        if behaviour.required or not (remaining or in_constraints or isinstance(behaviour.action, Speech)):
            return False
        self.behaviours[behaviour.id] = replace(behaviour, syncs=remaining)
        removed_syncs = ", ".join(sync for sync in behaviour.syncs if sync not in remaining)
        problem = f"'{behaviour.id}' is performed without its {removed_syncs}: '{dropped_id}' is dropped"
        self.add_notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, problem, behaviour.id)
        return True

    def _remove_from_constraint(self, constraint: Constraint, dropped_id: str) -> Iterable[Constraint]:
        """Return a constraint without a behaviour's sync points, if enough remain.

        Raises:
            BmlError: the constraint is required and has such points.
        """
        if not any(self._refers_to(ref, dropped_id) for ref in _list_refs(constraint)):
            return [constraint]
        if constraint.required:
            problem = f"a required constraint fails: '{dropped_id}' is dropped"
            raise document_error(self.block.source, constraint.place, problem, _REQUIRED_REMEDY)
        if isinstance(constraint, Synchronize):
            refs = tuple(ref for ref in constraint.refs if not self._refers_to(ref, dropped_id))
            return [replace(constraint, refs=refs)] if len(refs) > 1 else []
        later = tuple(ref for ref in constraint.later if not self._refers_to(ref, dropped_id))
        return (
            [replace(constraint, later=later)] if later and not self._refers_to(constraint.earlier, dropped_id) else []
        )

    def _release_speech_time(self, behaviour: Behaviour, sync: str, reason: str) -> bool:
        """Remove an infeasible time constraint from an optional speech.

        Returns:
            False if the behaviour is not an optional speech with such a time, or the time is its start.
        """
        is_spoken = isinstance(behaviour.action, Speech) and not behaviour.required
        if not is_spoken or sync == "start" or sync not in behaviour.syncs:
            return False
        remaining = {name: ref for name, ref in behaviour.syncs.items() if name != sync}
        self.behaviours[behaviour.id] = replace(behaviour, syncs=remaining)
        problem = f"'{behaviour.id}' is spoken without its {sync}: {reason}"
        self.add_notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, problem, behaviour.id)
        return True

    def _release_speech(self, loop: list[Edge]) -> bool:
        """Resolve contradicting times by removing a time constraint on a speech.

        The last of its times in the loop is removed, or a constraint on it.

        Returns:
            False if no constraint on a speech could be removed.
        """
        points = [point for edge in loop for point in (edge.tail, edge.head)]
        reason = _describe_loop(loop, self.block.id)
        for point in reversed(points):
            behaviour = self.behaviours.get(point.behaviour)
            if behaviour is not None and self._release_speech_time(behaviour, point.sync, reason):
                return True
        owners = {point.behaviour for point in points} - {"bml"}
        if all(isinstance(self.behaviours[name].action, Speech) for name in owners & self.behaviours.keys()):
            for constraint in self.constraints:
                if not constraint.required and any(get_point(ref) in points for ref in _list_refs(constraint)):
                    self.remove(constraint, NoticeType.IMPOSSIBLE_TO_SCHEDULE, reason)
                    return True
        return False

    def resolve(self, loops: list[list[Edge]]) -> None:
        """Resolve contradictory times by removing a constraint or dropping a behaviour."""
        for loop in loops:
            names = {point.behaviour for edge in loop for point in (edge.tail, edge.head)} - {"bml"}
            if self._release_speech(loop):
                continue
            if names <= self.behaviours.keys() and (candidates := [n for n in self.behaviours if n in names]):
                candidate = max(candidates, key=lambda name: (self._drop_rank(name), candidates.index(name)))
                self.drop(candidate, NoticeType.IMPOSSIBLE_TO_SCHEDULE, _describe_loop(loop, self.block.id))
            elif not names:
                self._remove_block_orders(loop)

    def _drop_rank(self, name: str) -> int:
        """Return the drop priority of a behaviour, the highest dropped first.

        Required behaviours have rank 0, speech 1, others 2, behaviours of other agents 3.
        """
        behaviour = self.behaviours[name]
        if behaviour.agent is not None:
            return 3
        return 0 if behaviour.required else 1 if isinstance(behaviour.action, Speech) else 2

    def _remove_block_orders(self, loop: list[Edge]) -> None:
        """Ignore precedence constraints that order two times of the block itself.

        Only these can contradict each other without a behaviour.
        """
        orders = [constraint for constraint in self.constraints if isinstance(constraint, Precedence)]
        for order in orders:
            if order.earlier.behaviour == "bml" and any(ref.behaviour == "bml" for ref in order.later):
                self.remove(order, NoticeType.IMPOSSIBLE_TO_SCHEDULE, _describe_loop(loop, self.block.id))


# remedy in the error for an infeasible required element
_REQUIRED_REMEDY = "remove it from <required>, or give it feasible times"


def _list_refs(item: Behaviour | Constraint) -> tuple[SyncRef, ...]:
    if isinstance(item, Behaviour):
        return tuple(item.syncs.values())
    return item.refs if isinstance(item, Synchronize) else (item.earlier, *item.later)


def _describe_loop(loop: list[Edge], block: str) -> str:
    """Describe a loop of contradicting constraints in a message."""
    corners = [
        edge.tail
        for before, edge in zip([loop[-1], *loop[:-1]], loop, strict=True)
        if edge.gap or before.gap or len({before.tail.behaviour, edge.tail.behaviour, edge.head.behaviour}) > 1
    ]
    names = [":".join(point[1:] if point.block == block else point) for point in corners]
    total = sum(edge.gap for edge in loop)
    excess = (
        f" by {total:g} s" if total > len(loop) * MIN_BEHAVIOUR_DURATION else ", which leaves no time to perform it"
    )
    if len({point.behaviour for point in corners} - {"bml"}) == 1:
        return f"its times contradict each other{excess}: {', '.join(names)}"
    return f"its times form an infeasible loop{excess}: {' -> '.join([*names, names[0]])}"


def _build_timeline(active: _ActiveSet, network: Network, spans: Mapping[str, Mapping[str, float]]) -> Timeline:
    natural = {name: find_natural_spans(b.action, spans.get(name, {})) for name, b in active.behaviours.items()}
    times = solve_times(network, natural)
    timed = []
    for chain in network.chains:
        sync_times = {point.sync: times[point] for point in chain.points}
        worst = max(sync_times.values(), key=abs)
        if abs(worst) > active.block.max_duration:
            problem = f"'{chain.behaviour.id}' would be at {worst:g} s"
            raise document_error(
                active.block.source,
                chain.behaviour.place,
                problem,
                f"a block lasts at most {active.block.max_duration:g} s: split it",
            )
        if chain.behaviour.agent is None:
            timed.append(TimedBehaviour(chain.behaviour, sync_times))
        else:
            active.skip(chain.behaviour, chain.behaviour.agent)
    return Timeline(active.block, tuple(timed), tuple(active.dropped), tuple(active.notices))

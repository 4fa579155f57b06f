"""Finds a time for every sync point; what cannot be timed is dropped with a notice, the rest performs."""

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
    refusal,
)
from kinesic.bml.reading.references import LONGEST_BLOCK
from kinesic.bml.timing.constraints import Tie, own_ties, point_of, relaxing_ties
from kinesic.bml.timing.negative_cycles import Edge, contradictions
from kinesic.bml.timing.network import SHORTEST_BEHAVIOUR, Elsewhere, Network, ReferenceResolver
from kinesic.bml.timing.points import natural_spans
from kinesic.bml.timing.settle import settle_times
from kinesic.body.utterance import Utterance

Constraint = Synchronize | Precedence


def schedule(
    block: Block,
    utterances: Mapping[str, Utterance],
    spans: Mapping[str, Mapping[str, float]],
    *,
    elsewhere: Elsewhere | None = None,
) -> Timeline:
    """Finds the times of all behaviours.

    Equalities hold exactly, sync points of a behaviour never go back, `after` and `before` hold; within this, phases
    are as near to their natural lengths as they can be (strokes first). A behaviour that cannot be timed is dropped.
    One that referred to it keeps its other references; when none is left it is dropped as well, unless it is a speech,
    which is then free. What other agents perform is timed, for others refer to it, and then left out.

    Args:
        block: what was asked.
        utterances: by id, what each speech will sound like.
        spans: behaviour id -> {sync point: natural seconds from the previous one of its type}; usual values else.
        elsewhere: (block, behaviour, sync point) of other blocks -> seconds of this block's time.

    Returns:
        The behaviours in document order with all their times, those that are dropped, and the notices.

    Raises:
        BmlError: a part that is required cannot be timed, or a time is beyond `LONGEST_BLOCK`.
    """
    cast = _Cast.of(block)
    for behaviour in block.behaviours:
        if isinstance(behaviour.action, Speech) and behaviour.id not in utterances:
            cast.drop(behaviour.id, NoticeType.CANNOT_CREATE_BEHAVIOR, "nobody says its text")
    while True:
        resolver = ReferenceResolver(block, cast.behaviours, utterances, elsewhere or {}, spans)
        network = resolver.network(cast.ties(), cast.constraints)
        for unresolved in resolver.unresolved:
            cast.give_up(unresolved.culprit, unresolved.kind, unresolved.why, unresolved.sync)
        if resolver.unresolved:
            continue
        loops = network.clashes() or contradictions(network.edges())
        cast.resolve(loops)
        if not loops:
            return _timeline(cast, network, spans)


@dataclass
class _Cast:
    """Behaviours and constraints that are still in, and what became of the others."""

    block: Block
    behaviours: dict[str, Behaviour]
    constraints: list[Constraint]
    dropped: list[Drop] = field(default_factory=list)
    notices: list[Notice] = field(default_factory=list)

    @classmethod
    def of(cls, block: Block) -> "_Cast":
        return cls(block, {b.id: b for b in block.behaviours}, list(block.constraints), [], list(block.notices))

    def ties(self) -> list[Tie]:
        """Equalities of attributes, and what they imply."""
        named = {point_of(ref) for constraint in self.constraints for ref in _refs(constraint)}
        every, block = self.behaviours.values(), self.block.id
        return [tie for each in every for tie in (*own_ties(each, block), *relaxing_ties(each, block, named))]

    def note(self, kind: NoticeType, text: str, behaviour: str | None = None) -> None:
        self.notices.append(Notice(kind, ":".join(filter(None, (self.block.id, behaviour))), text))

    def give_up(self, culprit: str | Constraint, kind: NoticeType, why: str, sync: str = "") -> None:
        """Drops a behaviour, or passes over a constraint or a time other than its start of a speech, where there is."""
        if isinstance(culprit, str):
            behaviour = self.behaviours.get(culprit)
            if behaviour is not None and not self._say_without(behaviour, sync, why):
                self.drop(culprit, kind, why)
        elif culprit in self.constraints:
            if culprit.required:
                raise refusal(self.block.source, culprit.place, f"a required constraint fails: {why}", _REMEDY)
            self.constraints.remove(culprit)
            self.note(kind, f"a constraint (line {culprit.place.line}) is passed over: {why}")

    def drop(self, name: str, kind: NoticeType, why: str) -> None:
        """Drops a behaviour, and what hangs on it alone."""
        going = [(name, kind, why)]
        for gone, kind, why in going:  # grows while it is walked
            behaviour = self.behaviours.pop(gone, None)
            if behaviour is None:
                continue
            if behaviour.required:
                what = f"the required {behaviour.type} '{gone}' cannot be performed: {why}"
                raise refusal(self.block.source, behaviour.place, what, _REMEDY)
            self.dropped.append(Drop(behaviour, why))
            self.note(kind, f"{behaviour.type} '{gone}' is dropped: {why}", gone)
            self.constraints = [kept for old in self.constraints for kept in self._without(old, gone)]
            for other in list(self.behaviours.values()):
                if any(self._is_of(ref, gone) for ref in _refs(other)) and not self._untied(other, gone):
                    reason = f"its times refer to '{gone}', which is dropped"
                    going.append((other.id, NoticeType.IMPOSSIBLE_TO_SCHEDULE, reason))

    def skip(self, behaviour: Behaviour, agent: str) -> None:
        """Leaves out what another agent performs, whose times others may refer to."""
        why = f"{agent} performs it"
        self.dropped.append(Drop(behaviour, why))
        self.note(
            NoticeType.CANNOT_CREATE_BEHAVIOR, f"{behaviour.type} '{behaviour.id}' is skipped: {why}", behaviour.id
        )

    def _is_of(self, ref: SyncRef, name: str) -> bool:
        return (ref.block, ref.behaviour) == (self.block.id, name)

    def _untied(self, behaviour: Behaviour, gone: str) -> bool:
        """Takes the references to a dropped behaviour away; False: nothing would be left."""
        left = {sync: ref for sync, ref in behaviour.syncs.items() if not self._is_of(ref, gone)}
        in_constraints = any(self._is_of(ref, behaviour.id) for c in self.constraints for ref in _refs(c))
        if behaviour.required or not (left or in_constraints or isinstance(behaviour.action, Speech)):
            return False
        self.behaviours[behaviour.id] = replace(behaviour, syncs=left)
        lost = ", ".join(sync for sync in behaviour.syncs if sync not in left)
        what = f"'{behaviour.id}' is performed without its {lost}: '{gone}' is dropped"
        self.note(NoticeType.IMPOSSIBLE_TO_SCHEDULE, what, behaviour.id)
        return True

    def _without(self, constraint: Constraint, gone: str) -> Iterable[Constraint]:
        """Takes the references to a dropped behaviour out of a constraint, if anything is left of it."""
        if not any(self._is_of(ref, gone) for ref in _refs(constraint)):
            return [constraint]
        if constraint.required:
            what = f"a required constraint fails: '{gone}' is dropped"
            raise refusal(self.block.source, constraint.place, what, _REMEDY)
        if isinstance(constraint, Synchronize):
            refs = tuple(ref for ref in constraint.refs if not self._is_of(ref, gone))
            return [replace(constraint, refs=refs)] if len(refs) > 1 else []
        later = tuple(ref for ref in constraint.later if not self._is_of(ref, gone))
        return [replace(constraint, later=later)] if later and not self._is_of(constraint.earlier, gone) else []

    def _say_without(self, behaviour: Behaviour, sync: str, why: str) -> bool:
        """Takes a time that cannot be met away from a speech, which is said all the same; False: it is not that."""
        is_spoken = isinstance(behaviour.action, Speech) and not behaviour.required
        if not is_spoken or sync == "start" or sync not in behaviour.syncs:
            return False
        left = {name: ref for name, ref in behaviour.syncs.items() if name != sync}
        self.behaviours[behaviour.id] = replace(behaviour, syncs=left)
        what = f"'{behaviour.id}' is said without its {sync}: {why}"
        self.note(NoticeType.IMPOSSIBLE_TO_SCHEDULE, what, behaviour.id)
        return True

    def _free_speech(self, loop: list[Edge]) -> bool:
        """Takes from a speech of a contradiction what makes it one: the last of its times, or a constraint on it."""
        points = [point for edge in loop for point in (edge.tail, edge.head)]
        why = _describe_loop(loop, self.block.id)
        for point in reversed(points):
            behaviour = self.behaviours.get(point.behaviour)
            if behaviour is not None and self._say_without(behaviour, point.sync, why):
                return True
        owners = {point.behaviour for point in points} - {"bml"}
        if all(isinstance(self.behaviours[name].action, Speech) for name in owners & self.behaviours.keys()):
            for constraint in self.constraints:
                if not constraint.required and any(point_of(ref) in points for ref in _refs(constraint)):
                    self.give_up(constraint, NoticeType.IMPOSSIBLE_TO_SCHEDULE, why)
                    return True
        return False

    def resolve(self, loops: list[list[Edge]]) -> None:
        """Drops one behaviour of each contradiction, unless a speech can be said without what makes it one."""
        for loop in loops:
            names = {point.behaviour for edge in loop for point in (edge.tail, edge.head)} - {"bml"}
            if self._free_speech(loop):
                continue
            if names <= self.behaviours.keys() and (candidates := [n for n in self.behaviours if n in names]):
                weakest = max(candidates, key=lambda name: (self._weakness(name), candidates.index(name)))
                self.drop(weakest, NoticeType.IMPOSSIBLE_TO_SCHEDULE, _describe_loop(loop, self.block.id))
            elif not names:
                self._give_up_constraint(loop)

    def _weakness(self, name: str) -> int:
        """Speech stays longer than the rest, what is required longer than speech; what others perform goes first."""
        behaviour = self.behaviours[name]
        if behaviour.agent is not None:
            return 3
        return 0 if behaviour.required else 1 if isinstance(behaviour.action, Speech) else 2

    def _give_up_constraint(self, loop: list[Edge]) -> None:
        """Passes over the orders between times of the block itself, which alone can contradict without a behaviour."""
        orders = [constraint for constraint in self.constraints if isinstance(constraint, Precedence)]
        for order in orders:
            if order.earlier.behaviour == "bml" and any(ref.behaviour == "bml" for ref in order.later):
                self.give_up(order, NoticeType.IMPOSSIBLE_TO_SCHEDULE, _describe_loop(loop, self.block.id))


_REMEDY = "take it out of <required>, or give it times that can be met"


def _refs(item: Behaviour | Constraint) -> tuple[SyncRef, ...]:
    if isinstance(item, Behaviour):
        return tuple(item.syncs.values())
    return item.refs if isinstance(item, Synchronize) else (item.earlier, *item.later)


def _describe_loop(loop: list[Edge], block: str) -> str:
    """Points between which only the order counts are left out."""
    turns = [
        edge.tail
        for before, edge in zip([loop[-1], *loop[:-1]], loop, strict=True)
        if edge.gap or before.gap or len({before.tail.behaviour, edge.tail.behaviour, edge.head.behaviour}) > 1
    ]
    names = [":".join(point[1:] if point.block == block else point) for point in turns]
    total = sum(edge.gap for edge in loop)
    excess = f" by {total:g} s" if total > len(loop) * SHORTEST_BEHAVIOUR else ", they leave no time to perform it"
    if len({point.behaviour for point in turns} - {"bml"}) == 1:
        return f"its times contradict one another{excess}: {', '.join(names)}"
    return f"its times go round in a loop that cannot be met{excess}: {' -> '.join([*names, names[0]])}"


def _timeline(cast: _Cast, network: Network, spans: Mapping[str, Mapping[str, float]]) -> Timeline:
    natural = {name: natural_spans(b.action, spans.get(name, {})) for name, b in cast.behaviours.items()}
    times = settle_times(network, natural)
    timed = []
    for chain in network.chains:
        own = {point.sync: times[point] for point in chain.points}
        worst = max(own.values(), key=abs)
        if abs(worst) > LONGEST_BLOCK:
            what = f"'{chain.behaviour.id}' would be at {worst:g} s"
            raise refusal(
                cast.block.source, chain.behaviour.place, what, f"a block lasts at most {LONGEST_BLOCK:g} s: split it"
            )
        if chain.behaviour.agent is None:
            timed.append(TimedBehaviour(chain.behaviour, own))
        else:
            cast.skip(chain.behaviour, chain.behaviour.agent)
    return Timeline(cast.block, tuple(timed), tuple(cast.dropped), tuple(cast.notices))

"""The references of a document: sync attributes of behaviours, and constraints."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from kinesic.bml.block import Behaviour, BmlError, NoticeType, Place, Precedence, Synchronize, SyncRef
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.syncref import Names, parse_ref, relation
from kinesic.bml.reading.tree import Element
from kinesic.bml.timing.points import sync_points

Constraint = Synchronize | Precedence

SYNC_ATTRIBUTES = (
    "start",
    "ready",
    "strokeStart",
    "attackPeak",
    "stroke",
    "strokeEnd",
    "relax",
    "end",
)
_ARRIVALS = ("ready", "attackPeak")  # of what stays, whose end is when it has come
_BY_LOWER_CASE = {name.lower(): name for name in SYNC_ATTRIBUTES}  # dialects misspell the case


@dataclass(frozen=True)
class ReferenceReader:
    """Reads references and says where they stand when they are wrong."""

    reading: DocumentReading
    names: Names

    def cues(self, behaviour: Behaviour, named: BehaviourElement) -> tuple[Behaviour, list[Precedence]]:
        """Adds the sync attributes of its element to a behaviour; `after(...)` and `before(...)` become orders.

        Raises:
            BmlError: an attribute is no reference.
        """
        syncs: dict[str, SyncRef] = {}
        orders: list[Precedence] = []
        points = sync_points(behaviour.action, self.reading.dialect)
        for name, text in named.attributes.items():
            sync = _BY_LOWER_CASE.get(name.lower())
            if sync in _ARRIVALS and sync not in points and "end" not in named.attributes:
                sync = "end"
            if sync is None or sync in syncs or not text.strip():
                continue
            if sync not in points:
                what = f"{name} is no sync point of <{behaviour.type}> and passed over"
                self.reading.note(NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, what, behaviour=behaviour.id)
                continue
            how, inner = relation(text)
            ref = self._ref(inner, name, behaviour.place)
            own = SyncRef(self.names.block, behaviour.id, sync)
            if how == "at":
                syncs[sync] = ref
            else:
                earlier, later = (ref, own) if how == "after" else (own, ref)
                orders.append(Precedence(earlier, (later,), behaviour.place, behaviour.required))
        return replace(behaviour, syncs=syncs), orders

    def constraints(self, constraint: Element, *, required: bool) -> Iterator[Constraint]:
        """Reads what a <constraint> holds.

        Raises:
            BmlError: a reference is missing or is none.
        """
        for element in constraint.children:
            inner = [self._of(child) for child in element.children if child.local == "sync"]
            match element.local:
                case "synchronize":
                    refs = ([self._of(element)] if "ref" in element.attributes else []) + inner
                    yield Synchronize(tuple(refs), element.place, required)
                case "after" if inner:
                    yield Precedence(self._of(element), tuple(inner), element.place, required)
                case "before":
                    ref = self._of(element)
                    yield from (Precedence(earlier, (ref,), element.place, required) for earlier in inner)

    def _of(self, element: Element) -> SyncRef:
        return self._ref(element.attributes.get("ref", ""), "ref", element.place)

    def _ref(self, text: str, attribute: str, place: Place) -> SyncRef:
        try:
            return parse_ref(text, self.names)
        except BmlError as error:
            what, _, remedy = str(error).partition("; ")
            raise self.reading.refuse(place, f"{attribute}: {what}", remedy) from None


def check_references(
    behaviours: tuple[Behaviour, ...], constraints: tuple[Constraint, ...], reading: DocumentReading
) -> None:
    """Refuses references to behaviours that this block does not have; other blocks are not looked into.

    Raises:
        BmlError: names the behaviour that is missing, and those that exist.
    """
    ids = {"bml", *(behaviour.id for behaviour in behaviours)}
    used = [(ref, behaviour.place) for behaviour in behaviours for ref in behaviour.syncs.values()]
    for constraint in constraints:
        refs = constraint.refs if isinstance(constraint, Synchronize) else (constraint.earlier, *constraint.later)
        used += [(ref, constraint.place) for ref in refs]
    for ref, place in used:
        if ref.block == reading.block and ref.behaviour not in ids:
            known = ", ".join(sorted(ids - {"bml"})) or "none"
            raise reading.refuse(place, f"no behaviour '{ref.behaviour}' in this block", f"it has {known}")
    own = {ref.behaviour for ref, _ in used if ref.block == reading.block}
    hyphened = sorted(name for name in own if "-" in name)
    if hyphened:
        what = f"ids with hyphens in references are outside of BML's grammar, taken as written: {', '.join(hyphened)}"
        reading.note(NoticeType.PARSING_FAILURE, what)

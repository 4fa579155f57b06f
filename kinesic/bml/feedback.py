"""BML 1.0 feedback, written as XML: what will happen, what happened, and what cannot.

Elements and attributes: facts, BML 1.0 section 2.7. Times in seconds, to the microsecond.
"""

from collections.abc import Mapping
from xml.etree.ElementTree import Element, SubElement, tostring

from kinesic.bml.block import FACE_SYNCS, GESTURE_SYNCS, Block, Notice
from kinesic.bml.reading.namespaces import BML_1_0, KINESIC, OWN_PREFIX
from kinesic.bml.timing.constraints import Point

_NAMED = frozenset({*GESTURE_SYNCS, *FACE_SYNCS})


def prediction(
    block: Block, start: float, end: float, times: Mapping[str, Mapping[str, float]], *, zero: float = 0.0
) -> str:
    """Writes a predictionFeedback: the block, and each behaviour with its predicted sync points.

    Sync points that BML names are attributes; marks of a speech and repeated strokes are <sync> elements inside.

    Args:
        block: that is to be performed; its behaviours have the names of their elements.
        start: of the block [s], block time.
        end: of the block [s], block time.
        times: behaviour id -> {sync point: time [s], block time}.
        zero: global time of the block's time 0 [s].
    """
    root = _root("predictionFeedback", block.character)
    SubElement(root, "bml", id=block.id, globalStart=_seconds(zero + start), globalEnd=_seconds(zero + end))
    types = {behaviour.id: behaviour.type for behaviour in block.behaviours}
    for behaviour, points in times.items():
        name = types.get(behaviour, "behavior").rpartition(":")[2]  # prefixes are declared nowhere here
        element = SubElement(root, name, id=f"{block.id}:{behaviour}")
        for sync, time in points.items():
            if sync in _NAMED:
                element.set(sync, _seconds(time))
            else:
                SubElement(element, "sync", id=sync, time=_seconds(time))
    return _written(root)


def block_progress(
    block: str,
    point: str,
    global_time: float,
    *,
    character: str | None = None,
    state: str | None = None,
    measured: float | None = None,
) -> str:
    """Writes a blockProgress: a block has reached a point.

    Args:
        block: id of the block.
        point: start, relax or end.
        global_time: [s].
        character: id of the character, if there are several.
        state: of the block when it ends before its time, in our namespace.
        measured: global time [s] at which the body was seen to be there, in our namespace.
    """
    root = _root("blockProgress", character)
    root.attrib.update(id=f"{block}:{point}", globalTime=_seconds(global_time))
    if state is not None:
        _own(root, "state", state)
    if measured is not None:
        _own(root, "measuredGlobalTime", _seconds(measured))
    return _written(root)


def sync_point_progress(
    point: Point, time: float, global_time: float, *, character: str | None = None, measured: float | None = None
) -> str:
    """Writes a syncPointProgress: a sync point was reached.

    Args:
        point: that was reached.
        time: since the start of the block [s].
        global_time: [s].
        character: id of the character, if there are several.
        measured: global time [s] at which the body was seen to be there, in our namespace with its lag.
    """
    root = _root("syncPointProgress", character)
    root.attrib.update(id=":".join(point), time=_seconds(time), globalTime=_seconds(global_time))
    if measured is not None:
        _own(root, "measuredGlobalTime", _seconds(measured))
        _own(root, "lag", _seconds(measured - global_time))
    return _written(root)


def warning(notice: Notice, *, character: str | None = None) -> str:
    """Writes a warningFeedback."""
    root = _root("warningFeedback", character)
    root.attrib.update(id=notice.id, type=notice.type.value)
    root.text = notice.text
    return _written(root)


def _own(root: Element, name: str, value: str) -> None:
    """The namespace is declared where it is used."""
    root.set(f"xmlns:{OWN_PREFIX}", KINESIC)
    root.set(f"{OWN_PREFIX}:{name}", value)


def _root(name: str, character: str | None) -> Element:
    root = Element(name, xmlns=BML_1_0)
    if character is not None:
        root.set("characterId", character)
    return root


def _seconds(time: float) -> str:
    return repr(round(float(time), 6) + 0.0)  # adding 0 turns -0.0 into 0.0


def _written(root: Element) -> str:
    return tostring(root, encoding="unicode")

"""Feedback in the XML of BML 1.0: predictions, progress and warnings.

Source of elements and attributes: BML 1.0, section 2.7. Times in seconds, rounded to microseconds.
"""

from collections.abc import Mapping
from xml.etree.ElementTree import Element, SubElement, tostring

from kinesic.bml.block import FACE_SYNCS, GESTURE_SYNCS, Block, Notice
from kinesic.bml.reading.namespaces import BML_1_0, KINESIC_NAMESPACE, KINESIC_PREFIX
from kinesic.bml.timing.constraints import Point

_STANDARD_SYNCS = frozenset({*GESTURE_SYNCS, *FACE_SYNCS})  # sync points written as attributes


def write_prediction(
    block: Block, start: float, end: float, times: Mapping[str, Mapping[str, float]], *, zero: float = 0.0
) -> str:
    """Return a predictionFeedback (XML) with the times of block and behaviours.

    Sync points named in BML are attributes; marks of a speech and repeated strokes are nested <sync> elements.

    Args:
        block: block to perform; its behaviours give the element names.
        start: start of the block [s], block time.
        end: end of the block [s], block time.
        times: behaviour id -> {sync point: time [s], block time}.
        zero: global time of block time 0 [s].
    """
    root = _make_root("predictionFeedback", block.character)
    SubElement(
        root, "bml", id=block.id, globalStart=_format_seconds(zero + start), globalEnd=_format_seconds(zero + end)
    )
    types = {behaviour.id: behaviour.type for behaviour in block.behaviours}
    for behaviour, points in times.items():
        name = types.get(behaviour, "behavior").rpartition(":")[2]  # prefixes are declared nowhere here
        element = SubElement(root, name, id=f"{block.id}:{behaviour}")
        for sync, time in points.items():
            if sync in _STANDARD_SYNCS:
                element.set(sync, _format_seconds(time))
            else:
                SubElement(element, "sync", id=sync, time=_format_seconds(time))
    return _serialise(root)


def write_block_progress(
    block: str,
    point: str,
    global_time: float,
    *,
    character: str | None = None,
    state: str | None = None,
    measured: float | None = None,
) -> str:
    """Return a blockProgress (XML) that reports a reached point of a block.

    Args:
        block: id of the block.
        point: start, relax or end.
        global_time: [s].
        character: id of the character if there are several.
        state: state of a block that ends early, in the kinesic namespace.
        measured: global time [s] at which the body reached the point, in the kinesic namespace.
    """
    root = _make_root("blockProgress", character)
    root.attrib.update(id=f"{block}:{point}", globalTime=_format_seconds(global_time))
    if state is not None:
        _add_kinesic_attribute(root, "state", state)
    if measured is not None:
        _add_kinesic_attribute(root, "measuredGlobalTime", _format_seconds(measured))
    return _serialise(root)


def write_sync_point_progress(
    point: Point, time: float, global_time: float, *, character: str | None = None, measured: float | None = None
) -> str:
    """Return a syncPointProgress (XML) that reports a reached sync point.

    Args:
        point: the reached point.
        time: time since the start of the block [s].
        global_time: [s].
        character: id of the character if there are several.
        measured: global time [s] at which the body reached the point; written with its lag in the kinesic namespace.
    """
    root = _make_root("syncPointProgress", character)
    root.attrib.update(id=":".join(point), time=_format_seconds(time), globalTime=_format_seconds(global_time))
    if measured is not None:
        _add_kinesic_attribute(root, "measuredGlobalTime", _format_seconds(measured))
        _add_kinesic_attribute(root, "lag", _format_seconds(measured - global_time))
    return _serialise(root)


def write_warning(notice: Notice, *, character: str | None = None) -> str:
    """Return a warningFeedback (XML) with a notice."""
    root = _make_root("warningFeedback", character)
    root.attrib.update(id=notice.id, type=notice.type.value)
    root.text = notice.text
    return _serialise(root)


def _add_kinesic_attribute(root: Element, name: str, value: str) -> None:
    """Add an attribute of the kinesic namespace and declare the namespace."""
    root.set(f"xmlns:{KINESIC_PREFIX}", KINESIC_NAMESPACE)
    root.set(f"{KINESIC_PREFIX}:{name}", value)


def _make_root(name: str, character: str | None) -> Element:
    root = Element(name, xmlns=BML_1_0)
    if character is not None:
        root.set("characterId", character)
    return root


def _format_seconds(time: float) -> str:
    return repr(round(float(time), 6) + 0.0)  # adding 0 turns -0.0 into 0.0


def _serialise(root: Element) -> str:
    return tostring(root, encoding="unicode")

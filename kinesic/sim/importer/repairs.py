"""Repair of single invalid values in a robot file, with notes.

MuJoCo refuses a whole robot for one of them.
"""

from collections.abc import Iterator, Mapping, Sequence
from xml.etree.ElementTree import Element

import numpy as np

from kinesic.body.arrays import Floats

UNIQUE_CHILDREN: Mapping[str, Sequence[str]] = {  # tag -> children of which only the first is kept
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "visual": ("origin", "geometry", "material"),
    "collision": ("origin", "geometry"),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller"),
    "body": ("inertial",),
}
SHAPE_SIZES: Mapping[str, Sequence[str]] = {  # tag of a URDF shape -> attributes that must be positive
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "box": ("size",),
}
INERTIA_KEYS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")  # order of MuJoCo's fullinertia
REPLACEMENT_INERTIA = 1e-5  # [kg m^2] inertia that replaces one without a positive diagonal
MAX_LINK_MASS = 10_000.0  # [kg] largest plausible mass of a link
REPLACEMENT_MASS = 1e-3  # [kg] mass that replaces one outside 0 to MAX_LINK_MASS


def repair(root: Element) -> tuple[str, ...]:
    """Repair the XML of a robot in place and return notes.

    Repeated elements are removed, shapes without size are left out, and impossible masses and inertias are replaced.
    """
    notes = [note for parent in root.iter() for note in _remove_repeated(parent)]
    for element in root.iter():
        if element.tag == "link":
            notes += [*_leave_out_shapes(element), *_repair_urdf_inertia(element)]
        elif element.tag == "joint" and root.tag == "robot":
            notes += _order_limits(element)
        elif element.tag == "body":
            notes += _repair_mjcf_inertia(element)
    return tuple(notes)


def _remove_repeated(parent: Element) -> Iterator[str]:
    for tag in UNIQUE_CHILDREN.get(parent.tag, ()):
        for repeated in parent.findall(tag)[1:]:
            parent.remove(repeated)
            yield f"{_name(parent)} has <{tag}> twice; the first is taken"


def _leave_out_shapes(link: Element) -> Iterator[str]:
    """Remove shapes of a URDF link without a positive size."""
    for kind in ("visual", "collision"):
        for shape in link.findall(kind):
            for tag, keys in SHAPE_SIZES.items():
                primitive = shape.find(f"geometry/{tag}")
                values = [] if primitive is None else _numbers(" ".join(primitive.get(key, "nan") for key in keys))
                if not all(np.isfinite(value) and value > 0.0 for value in values):
                    link.remove(shape)
                    yield f"a {tag} of {_name(link)} is left out: its size is not positive"


def _repair_urdf_inertia(link: Element) -> Iterator[str]:
    inertial = link.find("inertial")
    if inertial is None:
        return
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass is not None and not _is_mass(mass.get("value", "nan")):
        mass.set("value", str(REPLACEMENT_MASS))
        yield f"the mass of {_name(link)} is replaced by {REPLACEMENT_MASS:g} kg: it is not in 0..{MAX_LINK_MASS:g} kg"
    if inertia is not None:
        values = _numbers(" ".join(inertia.get(key, "0") for key in INERTIA_KEYS))
        if (sphere := _find_replacement(values)) is not None:
            inertia.attrib |= dict.fromkeys(INERTIA_KEYS[:3], str(sphere)) | dict.fromkeys(INERTIA_KEYS[3:], "0")
            yield _describe_inertia(link)


def _repair_mjcf_inertia(body: Element) -> Iterator[str]:
    inertial = body.find("inertial")
    if inertial is None:
        return
    if not _is_mass(inertial.get("mass", "nan")):
        inertial.set("mass", str(REPLACEMENT_MASS))
        yield f"the mass of {_name(body)} is replaced by {REPLACEMENT_MASS:g} kg: it is not in 0..{MAX_LINK_MASS:g} kg"
    for key in ("fullinertia", "diaginertia"):
        values = _numbers(inertial.get(key, ""))
        if values and (sphere := _find_replacement(values)) is not None:
            del inertial.attrib[key]
            inertial.set("diaginertia", f"{sphere} {sphere} {sphere}")
            yield _describe_inertia(body)


def _find_replacement(values: Sequence[float]) -> float | None:
    """Return a sphere's inertia [kg m^2] for an impossible one, otherwise None.

    Args:
        values: Diagonal of the inertia matrix, followed by the other elements or not [kg m^2].
    """
    diagonal, others = np.array(values[:3]), [*values[3:], 0.0, 0.0, 0.0]
    if len(diagonal) == 3 and np.isfinite([*diagonal, *others]).all():
        (ixy, ixz, iyz), matrix = others[:3], np.diag(diagonal)
        matrix += np.array([[0, ixy, ixz], [ixy, 0, iyz], [ixz, iyz, 0]])
        if float(np.linalg.eigvalsh(matrix)[0]) > 0.0:
            return None
    return _mean_positive(diagonal)


def _mean_positive(values: Floats) -> float:
    usable = values[np.isfinite(values) & (values > 0.0)]
    return float(usable.mean()) if len(usable) else REPLACEMENT_INERTIA


def _order_limits(joint: Element) -> Iterator[str]:
    """Exchange a URDF joint's limits if they are in reverse order."""
    limit = joint.find("limit")
    if limit is None:
        return
    lower, upper = _numbers(f"{limit.get('lower', '0')} {limit.get('upper', '0')}")[:2]
    if lower > upper:
        limit.attrib |= {"lower": limit.get("upper", "0"), "upper": limit.get("lower", "0")}
        yield f"the limits of {_name(joint)} are exchanged: the lower one is above the upper one"


def _is_mass(text: str) -> bool:
    values = _numbers(text)
    return len(values) == 1 and 0.0 <= values[0] <= MAX_LINK_MASS


def _numbers(text: str) -> list[float]:
    """Return the numbers of a text, NaN for other words."""
    return [_number(word) for word in text.split()]


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return float("nan")


def _describe_inertia(part: Element) -> str:
    return f"the inertia of {_name(part)} is replaced by that of a sphere: it is not positive definite"


def _name(element: Element) -> str:
    """Return an element's kind and name, such as `link head`."""
    name = element.get("name", "")
    return f"{element.tag} {name}" if name else f"a <{element.tag}>"

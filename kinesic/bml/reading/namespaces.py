"""Classification of names into BML and extensions by namespace or prefix.

The namespace decides if it is declared, otherwise the prefix.
"""

from kinesic.bml.reading.tree import Element

BML_1_0 = "http://www.bml-initiative.org/bml/bml-1.0"  # namespace of BML 1.0
CORE_EXTENSIONS = "http://www.bml-initiative.org/bml/coreextensions-1.0"  # namespace of BML's core extensions
DRAFT_NAMESPACES = ("http://www.mindmakers.org/projects/BML", "org.mindmakers.bml")  # namespaces of the BML draft
GRETA_NAMESPACES = frozenset({"vibnamespace", "gretanamespace"})  # Greta's namespaces, case-insensitive
KINESIC_NAMESPACE = "urn:kinesic"  # namespace of kinesic's attributes, such as kinesic:power
ASAP_NAMESPACE = "http://www.asap-project.org/bmla"  # namespace of the realizer ASAP
ELCKERLYC_NAMESPACE = "http://hmi.ewi.utwente.nl/bmlt"  # namespace of Elckerlyc, the predecessor of ASAP

CORE_NAMESPACES = frozenset({"", BML_1_0, CORE_EXTENSIONS, *DRAFT_NAMESPACES})  # namespaces of supported elements
CORE_PREFIXES = frozenset({"bml", "ext", "greta"})  # prefixes of supported elements, accepted without a declaration
KINESIC_PREFIX = "kinesic"  # prefix of kinesic's attributes, accepted without a declaration
COMPOSITION_NAMESPACES = frozenset({ASAP_NAMESPACE, ELCKERLYC_NAMESPACE})  # namespaces of block composition
COMPOSITION_PREFIXES = frozenset({"bmla", "bmlt"})  # prefixes of block composition, accepted without a declaration
COMPOSITION_ATTRIBUTES = frozenset(  # attributes for block composition, in lower case
    {"appendafter", "chunkafter", "prependbefore", "chunkbefore", "preplan", "interrupt", "onstart"}
    | {"allowexternalrefs"}  # has no effect: external references are always allowed
)
NEUTRAL_PREFIXES = frozenset({"xml", "xmlns", "xsi"})  # prefixes reserved by XML and XML Schema


def find_namespace(element: Element) -> str | None:
    """Return an element's namespace, or None if its prefix is undeclared."""
    return element.scope.get(element.name.rpartition(":")[0])


def is_core(element: Element, *, home: str | None) -> bool:
    """Return whether an element belongs to BML or a supported extension.

    Args:
        element: element to test.
        home: namespace of its <bml>, which counts as BML.
    """
    prefix = element.name.rpartition(":")[0]
    return _is_core(prefix, find_namespace(element), home)


def select_core_attributes(element: Element, *, home: str | None) -> dict[str, str]:
    """Return the BML attributes of an element by local name.

    Attributes without a prefix always belong to BML.
    """
    attributes: dict[str, str] = {}
    for name, value in element.attributes.items():
        prefix, _, local = name.rpartition(":")
        if not prefix or (prefix not in NEUTRAL_PREFIXES and _is_core(prefix, element.scope.get(prefix), home)):
            attributes.setdefault(local, value)
    return attributes


def select_kinesic_attributes(element: Element) -> dict[str, str]:
    """Return the attributes of the kinesic namespace, by name with prefix."""
    attributes = {}
    for name, value in element.attributes.items():
        prefix = name.rpartition(":")[0]
        if prefix and prefix not in NEUTRAL_PREFIXES and _is_kinesic(prefix, element.scope.get(prefix)):
            attributes[name] = value
    return attributes


def select_composition_attributes(element: Element) -> dict[str, str]:
    """Return the composition attributes of extensions by local name."""
    return {
        name.rpartition(":")[2]: value
        for name, value in element.attributes.items()
        if is_composition_name(name, element)
    }


def is_composition_name(name: str, element: Element) -> bool:
    """Return whether a prefixed name belongs to an extension for block composition."""
    prefix = name.rpartition(":")[0]
    uri = element.scope.get(prefix)
    return bool(prefix) and (prefix in COMPOSITION_PREFIXES if uri is None else uri in COMPOSITION_NAMESPACES)


def list_unknown_attributes(element: Element, *, home: str | None) -> list[str]:
    """List the attributes of unknown extensions by prefixed name."""
    prefixed = [name for name in element.attributes if ":" in name]
    return [
        name
        for name in prefixed
        if (prefix := name.rpartition(":")[0]) not in NEUTRAL_PREFIXES
        and not _is_core(prefix, element.scope.get(prefix), home)
        and not _is_kinesic(prefix, element.scope.get(prefix))
        and not (is_composition_name(name, element) and name.rpartition(":")[2].lower() in COMPOSITION_ATTRIBUTES)
    ]


def _is_kinesic(prefix: str, uri: str | None) -> bool:
    return prefix == KINESIC_PREFIX if uri is None else uri == KINESIC_NAMESPACE


def _is_core(prefix: str, uri: str | None, home: str | None) -> bool:
    if uri is None:
        return prefix in CORE_PREFIXES
    return uri in CORE_NAMESPACES or uri == home or uri.lower() in GRETA_NAMESPACES

"""Which names belong to BML: the namespace decides where there is one, the name where there is none."""

from kinesic.bml.reading.tree import Element

BML_1_0 = "http://www.bml-initiative.org/bml/bml-1.0"
EXTENSIONS = "http://www.bml-initiative.org/bml/coreextensions-1.0"
DRAFTS = ("http://www.mindmakers.org/projects/BML", "org.mindmakers.bml")
GRETA = frozenset({"vibnamespace", "gretanamespace"})  # in any case of their letters
KINESIC = "urn:kinesic"  # expressivity: kinesic:power="0.8"
ASAP = "http://www.asap-project.org/bmla"
ELCKERLYC = "http://hmi.ewi.utwente.nl/bmlt"  # ASAP's predecessor

CORE = frozenset({"", BML_1_0, EXTENSIONS, *DRAFTS})
CORE_PREFIXES = frozenset({"bml", "ext", "greta"})  # meant when nobody declares them
OWN_PREFIX = "kinesic"  # likewise
COMPOSING = frozenset({ASAP, ELCKERLYC})  # extensions in which blocks say what they do to one another
COMPOSING_PREFIXES = frozenset({"bmla", "bmlt"})  # likewise
COMPOSING_ATTRIBUTES = frozenset(  # in lower case
    {"appendafter", "chunkafter", "prependbefore", "chunkbefore", "preplan", "interrupt", "onstart"}
    | {"allowexternalrefs"}  # always allowed
)
NEUTRAL_PREFIXES = frozenset({"xml", "xmlns", "xsi"})


def namespace(element: Element) -> str | None:
    """Looks up the namespace of an element; None when its prefix is declared nowhere."""
    return element.scope.get(element.name.rpartition(":")[0])


def is_core(element: Element, *, home: str | None) -> bool:
    """Whether an element belongs to BML or to an extension that is understood.

    Args:
        element: to be judged.
        home: namespace of its <bml>, whatever that is.
    """
    prefix = element.name.rpartition(":")[0]
    return _is_core(prefix, namespace(element), home)


def core_attributes(element: Element, *, home: str | None) -> dict[str, str]:
    """Picks the attributes that are BML's, by local name; those without prefix always are."""
    attributes: dict[str, str] = {}
    for name, value in element.attributes.items():
        prefix, _, local = name.rpartition(":")
        if not prefix or (prefix not in NEUTRAL_PREFIXES and _is_core(prefix, element.scope.get(prefix), home)):
            attributes.setdefault(local, value)
    return attributes


def own_attributes(element: Element) -> dict[str, str]:
    """Picks the attributes of our namespace, by name with prefix as written."""
    found = {}
    for name, value in element.attributes.items():
        prefix = name.rpartition(":")[0]
        if prefix and prefix not in NEUTRAL_PREFIXES and _is_own(prefix, element.scope.get(prefix)):
            found[name] = value
    return found


def extension_attributes(element: Element) -> dict[str, str]:
    """Picks the attributes by which blocks say what they do to one another, by local name."""
    return {name.rpartition(":")[2]: value for name, value in element.attributes.items() if is_composing(name, element)}


def is_composing(name: str, element: Element) -> bool:
    """Whether a name with prefix, of an element or its attribute, is of an extension for what blocks do to others."""
    prefix = name.rpartition(":")[0]
    uri = element.scope.get(prefix)
    return bool(prefix) and (prefix in COMPOSING_PREFIXES if uri is None else uri in COMPOSING)


def foreign_attributes(element: Element, *, home: str | None) -> list[str]:
    """Lists, with prefix, the attributes of unknown extensions."""
    prefixed = [name for name in element.attributes if ":" in name]
    return [
        name
        for name in prefixed
        if (prefix := name.rpartition(":")[0]) not in NEUTRAL_PREFIXES
        and not _is_core(prefix, element.scope.get(prefix), home)
        and not _is_own(prefix, element.scope.get(prefix))
        and not (is_composing(name, element) and name.rpartition(":")[2].lower() in COMPOSING_ATTRIBUTES)
    ]


def _is_own(prefix: str, uri: str | None) -> bool:
    return prefix == OWN_PREFIX if uri is None else uri == KINESIC


def _is_core(prefix: str, uri: str | None, home: str | None) -> bool:
    if uri is None:
        return prefix in CORE_PREFIXES
    return uri in CORE or uri == home or uri.lower() in GRETA

"""The one form of a refusal: where, what, and what would have worked."""

from kinesic.bml.block import BmlError, Place


def refusal(source: str, place: Place, what: str, remedy: str) -> BmlError:
    """Builds the error of a document that is refused.

    Args:
        source: name of the document.
        place: line and column, from 1.
        what: what is wrong, with the value.
        remedy: what would have worked.
    """
    return BmlError(f"{source}:{place.line}:{place.column}: {what}; {remedy}")

"""Parsing of BML feedback: affected block, refusal and end."""

from dataclasses import dataclass
from xml.etree import ElementTree

from kinesic.bml.reading.namespaces import KINESIC_NAMESPACE

REFUSAL_PREFIXES = ("rule ", "not performed")  # beginnings of warnings about blocks that do not start
# Beginnings of warnings after which the server sends no end feedback for a block, even after its prediction.
FINAL_PREFIXES = (*REFUSAL_PREFIXES, "revoked", "a block of this id", "it is for ")
CROWDED_SERVER = "blocks play and wait already"  # part of the warning text if the server has too many blocks
BLOCK_END = ":end"  # suffix of the feedback's subject at a block end
STATE_ATTRIBUTE = f"{{{KINESIC_NAMESPACE}}}state"  # XML name of kinesic's attribute `state`


@dataclass(frozen=True)
class Feedback:
    """Parsed BML feedback message of the server."""

    kind: str  # name of the XML element
    subject: str  # id of block or behaviour; in progress messages with `:` and the sync point
    text: str
    type: str = ""  # type of a warning
    state: str = ""  # final state of a block that ends early, such as INTERRUPTED

    @property
    def is_refusal(self) -> bool:
        """Whether the message refuses a block that has no prediction yet."""
        is_warning = self.kind == "warningFeedback"
        return is_warning and (self.type == "PARSING_FAILURE" or self.text.startswith(REFUSAL_PREFIXES))

    @property
    def ended_block(self) -> str:
        """Id of the block ended by this feedback, or empty."""
        if self.kind == "blockProgress" and self.subject.endswith(BLOCK_END):
            return self.subject.removesuffix(BLOCK_END)
        is_over = self.text.startswith(FINAL_PREFIXES) or CROWDED_SERVER in self.text
        return self.subject if self.kind == "warningFeedback" and is_over else ""

    @property
    def outcome(self) -> str:
        """Outcome of an ended block in words.

        It is valid only for the end of a block.
        """
        if self.kind == "warningFeedback":
            return f"not performed: {self.text}"
        return self.state.lower() or "finished"

    def begins(self, block: str) -> bool:
        """Return whether this message predicts a block or reports its progress."""
        if self.kind == "predictionFeedback":
            return self.subject == block
        return self.kind == "blockProgress" and self.subject.rpartition(":")[0] == block


def read_feedback(message: str) -> Feedback | None:
    """Parse a server message as feedback, or return None for non-XML.

    Returns:
        The feedback; None for a message that is not XML.
    """
    try:
        root = ElementTree.fromstring(message)
    except ElementTree.ParseError:
        return None
    kind, subject = _local(root.tag), root.get("id", "")
    if kind == "predictionFeedback":  # the element itself has no id
        subject = next((part.get("id", "") for part in root if _local(part.tag) == "bml"), "")
    return Feedback(kind, subject, root.text or "", root.get("type", ""), root.get(STATE_ATTRIBUTE, ""))


def _local(tag: str) -> str:
    return tag.rpartition("}")[2]

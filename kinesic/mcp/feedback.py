"""Read BML feedback: its block, and whether that is refused or over."""

from dataclasses import dataclass
from xml.etree import ElementTree

REFUSAL_PREFIXES = ("rule ", "not performed")  # first words of a warning about a block that does not begin
# First words of a warning after which a block sends no end, although it was predicted.
FINAL_PREFIXES = (*REFUSAL_PREFIXES, "revoked", "a block of this id", "it is for ")
CROWDED_SERVER = "blocks play and wait already"
BLOCK_END = ":end"


@dataclass(frozen=True)
class Feedback:
    """One message of BML feedback."""

    kind: str  # name of its element
    subject: str  # id of the block or behaviour; of progress also `:` and the sync point
    text: str
    type: str = ""  # of a warning

    @property
    def is_refusal(self) -> bool:
        """Whether this refuses a block that has no prediction yet."""
        is_warning = self.kind == "warningFeedback"
        return is_warning and (self.type == "PARSING_FAILURE" or self.text.startswith(REFUSAL_PREFIXES))

    @property
    def ended_block(self) -> str:
        """Block that ends with this feedback, or an empty string."""
        if self.kind == "blockProgress" and self.subject.endswith(BLOCK_END):
            return self.subject.removesuffix(BLOCK_END)
        is_over = self.text.startswith(FINAL_PREFIXES) or CROWDED_SERVER in self.text
        return self.subject if self.kind == "warningFeedback" and is_over else ""

    def begins(self, block: str) -> bool:
        """Whether the block is expected to begin, or has begun."""
        if self.kind == "predictionFeedback":
            return self.subject == block
        return self.kind == "blockProgress" and self.subject.rpartition(":")[0] == block


def read_feedback(message: str) -> Feedback | None:
    """Read a message of the server.

    Returns:
        The feedback; None for a message that is not XML.
    """
    try:
        root = ElementTree.fromstring(message)
    except ElementTree.ParseError:
        return None
    kind, subject = _local(root.tag), root.get("id", "")
    if kind == "predictionFeedback":  # its own element has no id
        subject = next((part.get("id", "") for part in root if _local(part.tag) == "bml"), "")
    return Feedback(kind, subject, root.text or "", root.get("type", ""))


def _local(tag: str) -> str:
    return tag.rpartition("}")[2]

"""BML blocks that a conversation requests from the planner."""

from dataclasses import dataclass

from kinesic.conversation.turn_words import turn_words
from kinesic.conversation.wants import Filler

FILLER_BLOCK = "filler"  # prefix of the ids of blocks with fillers


@dataclass(frozen=True)
class ConversationBlock:
    """BML block to be planned for a conversation."""

    bml: str
    source: str  # name of the source in error messages


def filler_block(want: Filler, language: str, count: int) -> str:
    """Return the BML block of a filler.

    It is empty in a language without fillers.

    Args:
        want: requested filler.
        language: language tag.
        count: number of all fillers so far, for the block's id.
    """
    fillers = turn_words(language).fillers
    if not fillers:
        return ""
    text = fillers[(want.number - 1) % len(fillers)]
    return f'<bml id="{FILLER_BLOCK}{count}"><speech id="s"><text>{text}</text></speech></bml>'

"""Who performs what, where a block is for several agents: this robot its own part, the others theirs elsewhere."""

from collections.abc import Sequence
from dataclasses import replace

from kinesic.bml.block import Behaviour, NoticeType
from kinesic.bml.reading.reader import DocumentReading


def keep_own_part(
    behaviours: Sequence[Behaviour], character: str | None, performer: str | None, reading: DocumentReading
) -> list[Behaviour]:
    """Clears the agent of the behaviours that this robot performs; the others keep it, and are timed but skipped.

    Without a performer, whom the block is for performs; else the first agent that is named, which is noted.

    Args:
        behaviours: of a block, each with the agent that its element names.
        character: whom the block is for.
        performer: who this robot is.
        reading: gets the notice.
    """
    named = list(dict.fromkeys(agent for agent in (character, *(each.agent for each in behaviours)) if agent))
    own = performer or next(iter(named), "")
    if not performer and character is None and len(named) > 1:
        what = f"the block is for {' and '.join(named)}: {own} performs here, unless --character names another"
        reading.note(NoticeType.PARSING_FAILURE, what)
    return [_assigned(each, each.agent or character, own) for each in behaviours]


def _assigned(behaviour: Behaviour, agent: str | None, own: str) -> Behaviour:
    if agent is None or agent.casefold() == own.casefold():
        return replace(behaviour, agent=None)
    return replace(behaviour, agent=agent, required=False)

"""Assignment of behaviours to agents if a block addresses several agents."""

from collections.abc import Sequence
from dataclasses import replace

from kinesic.bml.block import Behaviour, NoticeType
from kinesic.bml.reading.reader import DocumentReading


def assign_agents(
    behaviours: Sequence[Behaviour], character: str | None, performer: str | None, reading: DocumentReading
) -> list[Behaviour]:
    """Mark the behaviours of this robot by removing their agent.

    Behaviours of other agents keep their agent; they are timed but skipped. Without a performer, this robot is the
    character of the block, or else the first agent named in the document; a notice reports the second case.

    Args:
        behaviours: behaviours of a block, each with the agent named by its element.
        character: character that the block addresses.
        performer: name of this robot.
        reading: receives the notice.
    """
    agents = list(
        dict.fromkeys(agent for agent in (character, *(behaviour.agent for behaviour in behaviours)) if agent)
    )
    performing_agent = performer or next(iter(agents), "")
    if not performer and character is None and len(agents) > 1:
        names = " and ".join(agents)
        problem = f"the block is for {names}: this robot performs {performing_agent}; choose another with --character"
        reading.add_notice(NoticeType.PARSING_FAILURE, problem)
    return [_assign(behaviour, behaviour.agent or character, performing_agent) for behaviour in behaviours]


def _assign(behaviour: Behaviour, agent: str | None, performing_agent: str) -> Behaviour:
    if agent is None or agent.casefold() == performing_agent.casefold():
        return replace(behaviour, agent=None)
    return replace(behaviour, agent=agent, required=False)

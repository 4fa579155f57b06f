"""Scene of a planner as its parts see it."""

from typing import Protocol

from kinesic.realizer.realizer import Scene
from kinesic.serve.shared_scene import Change


class ChangeableScene(Protocol):
    """Scene that is changed by proposals."""

    scene: Scene

    def propose(self, change: Change, /) -> object:
        """Propose a change of the scene."""

    def tell(self, message: str, client: int, /) -> None:
        """Send a message to a client."""

"""Access to the robot, whose server may still be starting."""

from asyncio import shield, wrap_future
from concurrent.futures import Future
from typing import TYPE_CHECKING

from kinesic.body.config import ConfigError
from kinesic.mcp.errors import RobotError
from kinesic.mcp.robot_line import RobotLine

if TYPE_CHECKING:
    from kinesic.planning.setup import Setup


class RobotGate:
    """Connections to a robot and its setup, which may still be loading."""

    def __init__(self, opened: "Future[RobotLine]", setup: "Future[Setup]") -> None:
        """Create access to a robot whose server may still be starting.

        Args:
            opened: the connections; its exception is a RobotError if the server does not start.
            setup: robot, language and style; its exception is a ConfigError if an option is invalid.
        """
        self._opened, self.setup = opened, setup

    @classmethod
    def of(cls, line: RobotLine, setup: "Setup") -> "RobotGate":
        """Return access to a robot with open connections and loaded setup."""
        opened: Future[RobotLine] = Future()
        loaded: Future[Setup] = Future()
        opened.set_result(line)
        loaded.set_result(setup)
        return cls(opened, loaded)

    async def line(self) -> RobotLine:
        """Wait for the connections to the robot and return them.

        Raises:
            RobotError: the server does not start.
        """
        return await shield(wrap_future(self._opened))

    async def ready_line(self) -> RobotLine:
        """Wait for the robot's connections and the planning setup.

        Loading the setup later would delay a stop of a moving robot.

        Raises:
            RobotError: the server does not start, or the setup is invalid.
        """
        line = await self.line()
        try:
            await shield(wrap_future(self.setup))
        except ConfigError as error:
            raise RobotError(str(error)) from None
        return line

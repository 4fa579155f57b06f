"""Streamed text of one client, parsed shortly before it is spoken."""

from collections import deque
from dataclasses import dataclass, field

from kinesic.intent.talk import Talk, add_words

MAX_PARSED_AHEAD = 4000  # [characters] length of parsed, unspoken text above which no further text is parsed
PIECE_LENGTH = 2000  # [characters] length of the pieces in which streamed text is parsed


@dataclass
class StreamedText:
    """Streamed text of one client, with its received but unparsed pieces."""

    talk: Talk
    heard: float  # [s] clock time of the last received text
    block: str = ""  # id of the last spoken block
    style: str = ""  # name of the text's style; empty: the server's style
    _pieces: deque[tuple[str, bool]] = field(default_factory=deque)  # received piece, and whether it ends the text
    _unread: int = 0  # [characters] total length of `_pieces`

    @property
    def waiting(self) -> int:
        """Number of received characters that are kept, parsed or not."""
        return self.talk.length + self._unread

    @property
    def is_read(self) -> bool:
        """Whether all received text is parsed."""
        return not self._pieces

    def take(self, text: str, now: float, *, ends: bool, instead: bool) -> None:
        """Add received text, or replace the text that is not spoken yet.

        Args:
            text: received text; words may be divided.
            now: clock time [s].
            ends: whether the text is complete.
            instead: whether it replaces all text that is not spoken yet.
        """
        if instead:
            self._pieces.clear()
            self._unread = 0
            self.talk = add_words(self.talk, "", instead=True)
        self.heard = now
        self._pieces.append((text, ends))
        self._unread += len(text)
        self.read_ahead()

    def read_ahead(self) -> None:
        """Parse received text until enough of it is ready to be spoken.

        A long text is not read at once, because that would delay its first phrase and other clients.
        """
        while self._pieces and self.talk.length < MAX_PARSED_AHEAD:
            text, ends = self._pieces.popleft()
            piece, rest = text[:PIECE_LENGTH], text[PIECE_LENGTH:]
            if rest:
                self._pieces.appendleft((rest, ends))
            self._unread -= len(piece)
            self.talk = add_words(self.talk, piece, ends=ends and not rest)

    def quiet(self, now: float) -> float:
        """Return the time [s] since text arrived, 0 while text is unparsed."""
        return now - self.heard if self.is_read else 0.0

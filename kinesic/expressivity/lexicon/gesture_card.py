"""Cards of gesture folders: name, licence and source of shared gestures."""

import json
from pathlib import Path

import msgspec

from kinesic.body.config import ConfigError, read_toml
from kinesic.expressivity.lexicon.captured_gesture import CARD_FILE
from kinesic.files.unicode_text import escape_surrogates

MAX_CARD_TEXT = 300  # [characters] longest text of one entry of a card
UNKNOWN_LICENCE = "unknown"  # licence of gestures whose author did not state one


class GestureCard(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Description of a folder of gestures that can be shared."""

    name: str  # name of the collection
    licence: str  # licence of the gestures
    source: str  # origin of the gestures
    description: str = ""  # one sentence about the gestures


def read_card(folder: Path) -> GestureCard:
    """Read the card of a folder of gestures.

    Raises:
        ConfigError: the card is missing, invalid or too long.
    """
    path = folder / CARD_FILE
    card = read_toml(path, GestureCard)
    for key in ("name", "licence", "source"):
        if not getattr(card, key).strip():
            raise ConfigError(f"{path}: {key} is empty; a shared collection must state it")
    for key, text in msgspec.structs.asdict(card).items():
        if len(text) > MAX_CARD_TEXT:
            raise ConfigError(f"{path}: {key} has {len(text)} characters, at most {MAX_CARD_TEXT} are read")
    return card


def card_text(card: GestureCard) -> str:
    """Return the TOML text of a card."""
    return "".join(f"{key} = {quote(text)}\n" for key, text in msgspec.structs.asdict(card).items())


def quote(text: str) -> str:
    """Return a TOML basic string.

    Control characters are escaped as in JSON, lone surrogates visibly.
    """
    return json.dumps(escape_surrogates(text)[:MAX_CARD_TEXT], ensure_ascii=False).replace("\x7f", "\\u007f")

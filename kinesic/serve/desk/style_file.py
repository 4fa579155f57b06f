"""Validation and list of the styles of a client's folder."""

from dataclasses import asdict, dataclass
from pathlib import Path

from kinesic.body.config import ConfigError, locate_config, names_of, parse_tables
from kinesic.expressivity.style.style import Style
from kinesic.serve.desk.draft import Json

UNNAMED_PATH = Path("the file")  # path that stands for the client's file in error messages
STYLE_KEY = "spatial"  # key that every style file has, and no gesture file
MAX_STYLE_SIZE = 20_000  # [bytes] largest style file


@dataclass(frozen=True)
class StyleEntry:
    """Style with the text of its file."""

    name: str
    text: str
    is_own: bool  # whether the style is a file of the client's folder

    def as_json(self) -> Json:
        """Return name, origin, text and gesture parameters of the style.

        Raises:
            ConfigError: the text is no style.
        """
        numbers = asdict(Style.parse(self.text, UNNAMED_PATH).gesture)
        return {"name": self.name, "own": self.is_own, "numbers": numbers, "text": self.text}


def list_builtin_styles() -> tuple[StyleEntry, ...]:
    """Return all built-in styles."""
    return tuple(
        StyleEntry(name, locate_config("style", name).read_text(encoding="utf-8"), is_own=False)
        for name in names_of("style")
    )


def is_style(text: str) -> bool:
    """Return whether a TOML text has the key of style files."""
    try:
        return STYLE_KEY in parse_tables(text, UNNAMED_PATH)
    except ConfigError:
        return False


def find_style_fault(text: str, present: str | None) -> str:
    """Return the reason against saving a style file, empty if none.

    Args:
        text: text of the file.
        present: text of the file that would be overwritten, or None.
    """
    if present is not None and not is_style(present):
        return "a file of this name exists and is no style; choose another name"
    if (size := len(text.encode("utf-8", "surrogatepass"))) > MAX_STYLE_SIZE:
        return f"it has {size} bytes, at most {MAX_STYLE_SIZE} are allowed in a style file"
    try:
        Style.parse(text, UNNAMED_PATH)
    except ConfigError as error:
        return str(error).removeprefix(f"{UNNAMED_PATH}: ")
    return ""

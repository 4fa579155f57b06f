"""Built-in documents, located by name."""

from difflib import get_close_matches
from pathlib import Path

from kinesic.body.config import CONFIGS

DOCUMENT_FOLDER = CONFIGS / "bml"  # folder of the built-in documents
DOCUMENT_SUFFIX = ".bml"  # suffix of the built-in documents
NAME_CUTOFF = 0.6  # smallest similarity, 0 to 1, between a missing name and a suggested one


def builtin_documents() -> dict[str, Path]:
    """Return the paths of the built-in documents by name, sorted."""
    return {file.stem: file for file in sorted(DOCUMENT_FOLDER.glob(f"*{DOCUMENT_SUFFIX}"))}


def locate_document(name: str | Path) -> Path:
    """Return the path of a file or built-in document of this name.

    An existing file is preferred. The path may be missing; `suggest_document` then names similar documents.
    """
    path = Path(name)
    return path if path.is_file() else builtin_documents().get(str(name), path)


def suggest_document(name: str | Path) -> str:
    """Return an error suffix that suggests built-in documents for a missing file.

    It is empty without a suggestion.
    """
    path, documents = Path(name), builtin_documents()
    if path.parent != Path() or path.suffix not in ("", DOCUMENT_SUFFIX):
        return ""
    near = get_close_matches(path.stem.lower(), documents, cutoff=NAME_CUTOFF)
    if near:
        return f"; did you mean the built-in {' or '.join(near)}?"
    return "" if path.suffix else f"; built-in documents: {', '.join(documents)}"

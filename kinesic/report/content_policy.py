"""Says to browsers what a page may do: run its own script, show what it carries, and nothing else."""

import hashlib
from base64 import b64encode


def content_policy(script: str, **more: str) -> str:
    """Writes the Content-Security-Policy of a page that carries everything.

    Should a stranger's words ever slip through as markup, no script of theirs runs, and nothing leaves the page.

    Args:
        script: the one that the page carries between its tags, to the letter.
        more: further directives, with _ for -, such as `img_src="data:"`.
    """
    digest = b64encode(hashlib.sha256(script.encode()).digest()).decode()
    directives = {
        "default-src": "'none'",
        "script-src": f"'sha256-{digest}'",
        "style-src": "'unsafe-inline'",
        "base-uri": "'none'",
        "form-action": "'none'",
        **{name.replace("_", "-"): value for name, value in more.items()},
    }
    return "; ".join(f"{name} {value}" for name, value in directives.items())

"""Pages opened in the user's browser."""

import webbrowser

from kinesic.face.show.window import has_display


def open_in_browser(url: str) -> bool:
    """Open a page in the user's browser.

    Returns:
        False without a desktop or a browser.
    """
    return has_display() and webbrowser.open(url)

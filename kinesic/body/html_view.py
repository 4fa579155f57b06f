"""Rich display of objects in notebooks.

`kinesic.report.display` makes the HTML. It is above all shown types, so it is found by name, at the first display.
"""

from kinesic.importing import import_at_once

DISPLAY_MODULE = "kinesic.report.display"  # module with the function `make_html`


class NotebookView:
    """Object that notebooks show as HTML."""

    def _repr_html_(self) -> str:
        """Return the HTML that notebooks show instead of the `repr`."""
        return str(import_at_once(DISPLAY_MODULE).make_html(self))

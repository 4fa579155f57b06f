"""SVG plots of the report page."""

"""Draws the figures of the report's page as SVG."""

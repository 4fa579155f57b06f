"""Packs the skin and the face of a figure for the scripts of pages."""

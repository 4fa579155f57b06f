"""Performances of one document with many servo variants."""

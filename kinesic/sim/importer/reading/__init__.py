"""Reads the files of foreign robots and bounds what they make."""

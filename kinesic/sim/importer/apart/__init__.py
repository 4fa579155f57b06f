"""Imports foreign robots in a process of their own."""

"""Minimal OpenGL bindings through ctypes, without further libraries."""

"""Smooth outer shells of robots for pictures: design, meshing, files and drawing."""

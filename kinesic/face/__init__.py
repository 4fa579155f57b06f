"""Shows the face: action units to a picture, in a window or a file."""

"""Shows the face."""

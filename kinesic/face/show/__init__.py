"""Shows the drawn face: in a window, in a picture or in a film."""

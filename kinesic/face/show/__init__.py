"""Display of the drawn face in a window, picture or film."""

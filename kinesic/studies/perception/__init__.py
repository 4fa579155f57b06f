"""A perception study of the face, as the thesis made one (4.4): stimuli, a page that asks, and the analysis."""

"""Makes the head: its mesh, its skin, and the shapes of its action units."""

"""Chapter 7 of the thesis as it was written: ball joints, masses, springs and boxed Euler limits."""

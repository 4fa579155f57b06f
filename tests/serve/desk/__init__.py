"""In a package, so that what its tests share is made once."""

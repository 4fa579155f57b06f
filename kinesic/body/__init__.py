"""Robot descriptions, and the types that all packages use."""

"""Live: blocks come one after the other, by whatever wire, and are performed as they come."""

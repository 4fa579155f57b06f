"""Secondary motion: breath, drift, speech movements, head arcs and follow-through."""

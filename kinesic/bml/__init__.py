"""Reading of BML documents and scheduling of their behaviours."""

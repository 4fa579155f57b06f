"""A study of gestures: which of six meanings people see in each, and which performance looks more natural to them."""

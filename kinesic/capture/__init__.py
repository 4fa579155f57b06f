"""Motion from elsewhere: reading, retargeting to a robot and certification."""

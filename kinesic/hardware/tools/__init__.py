"""What people do with servos by hand: looking, releasing, calibrating, finding what is wrong."""

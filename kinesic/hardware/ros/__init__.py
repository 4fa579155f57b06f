"""ROS 2 over rosbridge: joint commands out, reports of people in."""

"""ROS 2: joint commands to robots and reports of people, without a ROS installation."""

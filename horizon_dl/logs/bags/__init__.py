"""ROS bags of both generations: their files, messages, transforms, cameras and attitudes."""

"""Camera files of every kind: intrinsics, and the mount of the camera in the body."""

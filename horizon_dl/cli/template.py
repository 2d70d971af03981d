"""Files to fill in, for data of your own.

horizon-dl template frames.csv > flight/frames.csv       images with their attitude
horizon-dl template attitude.csv > log.csv               the attitude log of a film
horizon-dl template camera.yaml > flight/camera.yaml     the camera and its mount
"""

import argparse

TEMPLATES = {
    "frames.csv": """\
image,time_s,roll_rad,pitch_rad,yaw_rad,height_m
images/000000.jpg,0.00,0.00,-0.10,0.00,1.20
images/000001.jpg,0.10,0.01,-0.11,0.02,1.21
""",
    "attitude.csv": """\
time_s,roll_rad,pitch_rad,yaw_rad,height_m
0.00,0.00,-0.10,0.00,1.20
0.02,0.00,-0.10,0.00,1.20
""",
    "camera.yaml": """\
# The camera, as a calibration gives it (Kalibr, ROS, OpenCV and other files are read as well).
model: radtan            # pinhole, radtan (OpenCV k1 k2 p1 p2 k3) or kannala_brandt (OpenCV fisheye k1 to k4)
width: 640               # of the upright image, pixels
height: 480
fx: 500.0
fy: 500.0
cx: 319.5                # pixel centres at integers
cy: 239.5
distortion: [0.0, 0.0, 0.0, 0.0, 0.0]
rotate_image: none       # 90ccw, 90cw or 180: how the stored image is turned to be upright
mount_rpy_deg: [0.0, 0.0, 0.0]   # roll, pitch, yaw of the camera in the body; pitch -20 looks 20 degrees down
""",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the verb."""
    parser.add_argument("name", choices=tuple(TEMPLATES))


def run(arguments: argparse.Namespace) -> None:
    """Print the file."""
    print(TEMPLATES[arguments.name], end="")

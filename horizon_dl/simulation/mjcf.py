"""A scene in MuJoCo's model language."""

import math
from collections.abc import Sequence

from horizon_dl.simulation.faces import Face, Tube
from horizon_dl.simulation.scene import FLOOR, Scene

LAMPS = 3  # indoors the first one casts shadows


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{value:.6g}" for value in values)


def _face(face: Face) -> str:
    axes = _numbers((*face.right, *face.up))
    spacing = 0.5  # lighting is computed at the corners of squares of this size
    return (
        f'<geom type="plane" pos="{_numbers(face.centre)}" xyaxes="{axes}" '
        f'size="{_numbers((*face.half_m, spacing))}" material="m{face.texture}"/>'
    )


def _tube(tube: Tube) -> str:
    return (
        f'<geom type="cylinder" pos="{_numbers(tube.centre)}" '
        f'size="{_numbers((tube.radius_m, tube.half_height_m))}" rgba="{_numbers((*tube.colour, 1.0))}"/>'
    )


def _assets(scene: Scene) -> list[str]:
    lines = [
        '<texture type="skybox" builtin="gradient" rgb1=".42 .58 .80" rgb2=".80 .83 .85" '
        'width="64" height="384"/>'
    ]
    for index, texture in enumerate(scene.textures):
        height, width = texture.shape[:2]
        lines.append(f'<texture name="t{index}" type="2d" builtin="flat" width="{width}" height="{height}"/>')
        shine = f' reflectance="{scene.arena.shine:.3g}"' if index == FLOOR and scene.arena.shine else ""
        lines.append(f'<material name="m{index}" texture="t{index}" specular="0" shininess="0"{shine}/>')
    return lines


def _lights(scene: Scene) -> list[str]:
    arena = scene.arena
    if arena.sun_rad is not None:
        return _sunlight(*arena.sun_rad)
    spots = ((0.28, 0.22), (-0.3, 0.1), (0.05, -0.35))
    lines = []
    for index, (x, y) in enumerate(spots[:LAMPS]):
        place = _numbers((x * arena.length_m, y * arena.width_m, arena.wall_m - 0.05))
        lines.append(
            f'<light pos="{place}" dir="0 0 -1" cutoff="88" exponent="0.6" attenuation="1 0 0.012" '
            f'diffuse=".4 .4 .4" specular="0 0 0" castshadow="{"true" if index == 0 else "false"}"/>'
        )
    return lines


def _sunlight(azimuth_rad: float, height_rad: float) -> list[str]:
    """The sun, and the sky from two sides; the shadows are painted on the floor."""
    level = math.cos(height_rad)
    sun = (level * math.cos(azimuth_rad), level * math.sin(azimuth_rad), math.sin(height_rad))
    directions = ((sun, 0.7), ((-sun[0], -sun[1], 1.0), 0.15), ((sun[1], -sun[0], 1.0), 0.15))
    return [
        f'<light directional="true" pos="0 0 9" dir="{_numbers([-part for part in source])}" '
        f'diffuse="{strength} {strength} {strength}" specular="0 0 0" castshadow="false"/>'
        for source, strength in directions
    ]


def mjcf(scene: Scene, width: int, height: int, samples: int) -> str:
    """The model as XML: geoms in the order faces, tubes; one camera; lamps. Pictures are filled in later.

    Args:
        scene: what to describe.
        width: of the off-screen buffer, pixels.
        height: of the off-screen buffer, pixels.
        samples: multisamples a pixel.
    """
    geoms = [_face(face) for face in scene.faces] + [_tube(tube) for tube in scene.tubes]
    return "\n".join(
        (
            "<mujoco><compiler angle='degree'/><statistic extent='1' center='0 0 1'/>",
            f'<visual><global offwidth="{width}" offheight="{height}"/>',
            f'<quality offsamples="{samples}" shadowsize="768"/>',
            '<map znear="0.05" zfar="60"/>',
            '<headlight ambient=".42 .42 .42" diffuse=".1 .1 .1" specular="0 0 0"/></visual>',
            "<asset>",
            *_assets(scene),
            '</asset><default><geom contype="0" conaffinity="0" group="0"/></default><worldbody>',
            *_lights(scene),
            '<camera name="drone" pos="0 0 1"/>',
            *geoms,
            "</worldbody></mujoco>",
        )
    )

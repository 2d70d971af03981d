"""What a small camera makes of light: exposure, white balance, vignette, noise, blur along the exposure."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Light = NDArray[np.float32]

GAMMA = 2.2
TARGET = 0.36  # mean brightness, sRGB in [0, 1], that the exposure aims at
# Sub-pixel shifts of the sub-frames (right, down): a rotated grid, so that their mean is smooth at edges.
JITTER_PX = ((-0.375, -0.125), (0.125, -0.375), (0.375, 0.125), (-0.125, 0.375))


@dataclass
class AutoExposure:
    """Exposure that follows the brightness with a delay and hunts a little.

    Attributes:
        gain: factor on linear light now.
    """

    gain: float = 1.0

    def follow(self, linear_mean: float) -> None:
        """Take a tenth to a third of the way to the gain that the last frame asks for."""
        wanted = TARGET**GAMMA / max(linear_mean, 1e-3)
        self.gain *= float(np.clip(wanted / self.gain, 0.25, 4.0)) ** 0.22

    @property
    def exposure_s(self) -> float:
        """Shutter time: longer in the dark, 5 to 18 ms."""
        return float(np.clip(0.010 * self.gain, 0.005, 0.018))


def vignette(height: int, width: int) -> Light:
    """Fall-off of the lens: 1 in the centre, 0.8 in the corners; (h, w, 1)."""
    v, u = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    return np.asarray((1 - 0.1 * (u**2 + v**2))[..., None], np.float32)


def to_linear(pictures: list[NDArray[np.uint8]]) -> Light:
    """Mean of sRGB pictures in linear light: (h, w, 3) in [0, 1]."""
    table = ((np.arange(256) / 255.0) ** GAMMA / len(pictures)).astype(np.float32)
    return np.asarray(np.sum([table[picture] for picture in pictures], axis=0), np.float32)


def develop(
    rng: np.random.Generator, linear: Light, gain: float, balance: NDArray[np.float64], noise: float
) -> NDArray[np.uint8]:
    """Linear light to the camera's 8-bit picture.

    Args:
        rng: of the noise.
        linear: (h, w, 3) light, vignette included.
        gain: exposure.
        balance: (3,) white balance, about 1.
        noise: strength of the sensor noise, 1 = small camera indoors.

    Returns:
        (h, w, 3) uint8 sRGB, with a veil of stray light, photon noise, read noise and blotchy colour noise.
    """
    light = linear * (gain * balance).astype(np.float32) + np.float32(0.006)
    root = np.sqrt(light)
    coarse = _normal(rng, ((linear.shape[0] + 3) // 4, (linear.shape[1] + 3) // 4, 3)) * 0.006
    blotches = coarse.repeat(4, axis=0).repeat(4, axis=1)[: linear.shape[0], : linear.shape[1]]
    grain = root * (0.022 * _normal(rng, light.shape) + blotches) + 0.0035 * _normal(rng, light.shape)
    level = np.clip(light + np.float32(noise) * grain, 0, 1) * 4095
    return np.asarray(_TONE_CURVE[level.astype(np.uint16)])


def _normal(rng: np.random.Generator, shape: tuple[int, ...]) -> Light:
    return rng.standard_normal(shape, dtype=np.float32)


# 12-bit light to 8-bit sRGB, as the camera's own converter does it
_TONE_CURVE = (((np.arange(4096) + 0.5) / 4096) ** (1 / GAMMA) * 255 + 0.5).astype(np.uint8)

"""Headless MuJoCo renderer of a scene: colour at any pose, and depth with labels in one pass."""

import ctypes
import importlib
import os
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from horizon_dl.errors import InputError
from horizon_dl.simulation.mjcf import mjcf
from horizon_dl.simulation.scene import Scene, truth_of_geoms

_BACKENDS = {"egl": ("libEGL.so.1", "libOpenGL.so.0"), "osmesa": ("libOSMesa.so.8", "libOpenGL.so.0")}
_WAY_OUT = "install the Debian packages libegl1, libgl1-mesa-dri and libopengl0 (software rendering suffices)"


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def choose_backend() -> str:
    """Name of the headless OpenGL that MuJoCo is to use: MUJOCO_GL where set, else EGL, else OSMesa.

    Raises:
        InputError: none is installed.
    """
    wanted = os.environ.get("MUJOCO_GL")
    if wanted:
        return wanted
    for name, libraries in _BACKENDS.items():
        if all(_loads(library) for library in libraries):
            return name
    raise InputError("simulation", "no OpenGL that works without a screen (EGL, OSMesa)", _WAY_OUT)


def import_mujoco() -> Any:
    """The mujoco module, bound to a headless OpenGL.

    Raises:
        InputError: mujoco is not installed, or its OpenGL does not load.
    """
    os.environ["MUJOCO_GL"] = choose_backend()
    # torch's compiler and Mesa's software renderer both bring LLVM; triton crashes where Mesa was first.
    with suppress(ImportError):
        importlib.import_module("triton._C.libtriton")
    try:
        import mujoco
    except ModuleNotFoundError as error:
        raise InputError("simulation", f"needs {error.name}", "pip install 'horizon-dl[sim]'") from error
    except Exception as error:  # PyOpenGL fails in its own ways where a library is missing
        raise InputError("simulation", f"OpenGL does not load ({error})", _WAY_OUT) from error
    return mujoco


class SceneRenderer:
    """Renders one scene from camera poses; use it in a `with` block.

    The camera is a pinhole with square pixels and its principal point in the image's centre. A pose is the
    camera's place (3,) in metres in the world (x north, y west, z up), and (3, 3) with the optical axes
    (x right, y down, z forward) as columns.

    Raises:
        InputError: rendering is not possible on this machine.
    """

    def __init__(self, scene: Scene, width: int, height: int, focal_px: float, samples: int = 0) -> None:
        mj = self._mj = import_mujoco()
        self._size = (height, width)
        self._truth = truth_of_geoms(scene)
        self._model = mj.MjModel.from_xml_string(mjcf(scene, width, height, samples))
        self._model.cam_fovy[0] = np.rad2deg(2 * np.arctan(height / 2 / focal_px))
        self._fill_textures(scene)
        self._data = mj.MjData(self._model)
        mj.mj_forward(self._model, self._data)
        self._open_context(width, height)
        self._lamps = self._model.light_diffuse.copy()

    def _fill_textures(self, scene: Scene) -> None:
        offset = self._model.ntex - len(scene.textures)
        for index, texture in enumerate(scene.textures):
            start = int(self._model.tex_adr[offset + index])
            pixels = np.ascontiguousarray(texture).ravel()
            self._model.tex_data[start : start + pixels.size] = pixels

    def _open_context(self, width: int, height: int) -> None:
        mj = self._mj
        try:
            self._gl = mj.GLContext(width, height)
            self._gl.make_current()
            self._context = mj.MjrContext(self._model, mj.mjtFontScale.mjFONTSCALE_100)
        except Exception as error:  # each backend raises its own kinds
            raise InputError("simulation", f"OpenGL does not start ({error})", _WAY_OUT) from error
        mj.mjr_setBuffer(mj.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._context.readDepthMap = mj.mjtDepthMap.mjDEPTH_ZEROFAR
        self._rect = mj.MjrRect(0, 0, width, height)
        self._mjv = mj.MjvScene(self._model, maxgeom=2000)
        self._option, self._camera = mj.MjvOption(), mj.MjvCamera()
        self._camera.type, self._camera.fixedcamid = mj.mjtCamera.mjCAMERA_FIXED, 0

    def __enter__(self) -> "SceneRenderer":
        return self

    def __exit__(self, *_: object) -> None:
        self._context.free()
        self._gl.free()

    def set_lamps(self, factors: NDArray[np.float64]) -> None:
        """Brightness of the lamps, one factor each, 1 = as built."""
        self._model.light_diffuse[: len(factors)] = self._lamps[: len(factors)] * factors[:, None]

    def _draw(self, place: NDArray[np.float64], axes: NDArray[np.float64], identities: bool) -> None:
        mj = self._mj
        self._data.cam_xpos[0] = place
        self._data.cam_xmat[0] = (axes * (1.0, -1.0, -1.0)).ravel()  # OpenGL looks along -z with y up
        everything = mj.mjtCatBit.mjCAT_ALL
        mj.mjv_updateScene(self._model, self._data, self._option, None, self._camera, everything, self._mjv)
        for flag in (mj.mjtRndFlag.mjRND_SEGMENT, mj.mjtRndFlag.mjRND_IDCOLOR):
            self._mjv.flags[flag] = identities
        mj.mjr_render(self._rect, self._mjv, self._context)

    def colour(self, place: NDArray[np.float64], axes: NDArray[np.float64]) -> NDArray[np.uint8]:
        """The picture at a pose: (h, w, 3) uint8 RGB."""
        self._draw(place, axes, identities=False)
        rgb = np.empty((*self._size, 3), np.uint8)
        self._mj.mjr_readPixels(rgb, None, self._rect, self._context)
        return rgb[::-1]

    def truth(
        self, place: NDArray[np.float64], axes: NDArray[np.float64]
    ) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
        """Labels and depth at a pose, both of the surface at the pixel's centre.

        Returns:
            labels (h, w) uint8 of `Truth`; depth (h, w) metres along the optical axis, 0 for the sky.
        """
        self._draw(place, axes, identities=True)
        rgb = np.empty((*self._size, 3), np.uint8)
        raw = np.empty(self._size, np.float32)
        self._mj.mjr_readPixels(rgb, raw, self._rect, self._context)
        code = rgb[::-1].astype(np.int64) @ (1, 256, 65536)
        geom_of_code = np.full(self._mjv.ngeom + 1, len(self._truth) - 1)
        for geom in self._mjv.geoms[: self._mjv.ngeom]:
            if geom.segid >= 0 and geom.objtype == self._mj.mjtObj.mjOBJ_GEOM:
                geom_of_code[geom.segid + 1] = geom.objid
        depth = self._metres(raw[::-1].astype(np.float64))
        return self._truth[geom_of_code[code]], np.where(code == 0, 0.0, depth)

    def _metres(self, raw: NDArray[np.float64]) -> NDArray[np.float64]:
        """Reversed OpenGL depth (1 near, 0 far) to metres along the optical axis."""
        near = self._model.vis.map.znear * self._model.stat.extent
        far = self._model.vis.map.zfar * self._model.stat.extent
        metres: NDArray[np.float64] = near * far / (near + raw * (far - near))
        return metres

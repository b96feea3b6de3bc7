"""Pictures of the kitchen, where the machine has a library that draws off screen (EGL or OSMesa). Nothing else needs one."""

from __future__ import annotations

import importlib
import io
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.errors import InputError, MissingDependencyError, alternatives
from symskill_pddl.files import write_atomic
from symskill_pddl.geometry import Array
from symskill_pddl.kitchen.backend import load_mujoco
from symskill_pddl.kitchen.world import Kitchen


class Camera:
    """Draws a kitchen from a fixed camera; keeps its graphics context, so make one and use it often.

    Parameters
    ----------
    kitchen : Kitchen
    name : str
        One of the model's cameras: 'overview', 'inside', and those of robosuite's room and hand.
    width, height : int
        Size of the picture [pixels].
    quick : bool
        Without shadows, reflections and smoothed edges: half the time, for films.

    Raises
    ------
    InputError
        There is no such camera.
    MissingDependencyError
        No library for off-screen drawing.
    """

    def __init__(
        self, kitchen: Kitchen, name: str = "overview", width: int = 640, height: int = 480, *, quick: bool = False
    ) -> None:
        mj, model = load_mujoco(), kitchen.physics.model
        names = [model.camera(i).name for i in range(model.ncam)]
        if name not in names:
            raise InputError(f"unknown camera '{name}'; the kitchen has: {alternatives(names)}")
        self._kitchen, self._mj, self._size = kitchen, mj, (width, height)
        model.vis.global_.offwidth = max(width, model.vis.global_.offwidth)
        model.vis.global_.offheight = max(height, model.vis.global_.offheight)
        if quick:
            model.vis.quality.offsamples = 0
        self._gl = _context(width, height)
        self._gl.make_current()
        self._scene = mj.MjvScene(model, 2000)
        self._context = mj.MjrContext(model, mj.mjtFontScale.mjFONTSCALE_100)
        mj.mjr_setBuffer(mj.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._camera, self._options = mj.MjvCamera(), mj.MjvOption()
        # group 0 holds robosuite's collision shapes; fixtures are drawn as they collide, in group 2
        self._options.geomgroup[0] = 0
        self._options.sitegroup[:] = 0
        self._camera.type, self._camera.fixedcamid = mj.mjtCamera.mjCAMERA_FIXED, names.index(name)
        for flag in (mj.mjtRndFlag.mjRND_SHADOW, mj.mjtRndFlag.mjRND_REFLECTION):
            self._scene.flags[flag] = not quick
        # all that decides where things are: joints, and bodies that are moved by hand
        self._moment = int(mj.mjtState.mjSTATE_QPOS | mj.mjtState.mjSTATE_MOCAP_POS | mj.mjtState.mjSTATE_MOCAP_QUAT)
        self._then = mj.MjData(model)

    def moment(self) -> Array:
        """Where everything is now, for a later `image`."""
        physics = self._kitchen.physics
        state = np.empty(self._mj.mj_stateSize(physics.model, self._moment))
        self._mj.mj_getState(physics.model, physics.data, state, self._moment)
        return state

    def image(self, moment: Array | None = None) -> NDArray[np.uint8]:
        """What the camera sees now, or saw at a `moment()`: (height, width, 3)."""
        mj, (width, height), model = self._mj, self._size, self._kitchen.physics.model
        self._gl.make_current()
        data = self._kitchen.physics.data
        if moment is not None:
            data = self._then
            mj.mj_setState(model, data, moment, self._moment)
            for place in (mj.mj_kinematics, mj.mj_comPos, mj.mj_camlight):
                place(model, data)
        mj.mjv_updateScene(model, data, self._options, None, self._camera, mj.mjtCatBit.mjCAT_ALL.value, self._scene)
        view = mj.MjrRect(0, 0, width, height)
        image = np.zeros((height, width, 3), dtype=np.uint8)
        mj.mjr_render(view, self._scene, self._context)
        mj.mjr_readPixels(image, None, view, self._context)
        return np.flipud(image)

    def close(self) -> None:
        """Release the graphics context."""
        self._context.free()
        self._gl.free()


def picture(kitchen: Kitchen, path: str | Path, camera: str = "overview") -> Path:
    """Write what a camera sees now as PNG and return the path. Errors as for `Camera` and `write_atomic`."""
    from PIL import Image

    view = Camera(kitchen, camera)
    try:
        content = io.BytesIO()
        Image.fromarray(view.image()).save(content, format="png")
        write_atomic(path, content.getvalue())
    finally:
        view.close()
    return Path(path)


def check_drawing() -> None:
    """Raise MissingDependencyError unless there is a library for off-screen drawing."""
    load_mujoco()
    _context(16, 16).free()


def _context(width: int, height: int) -> Any:
    """An off-screen context, whatever MUJOCO_GL was when mujoco was imported: EGL first, then OSMesa."""
    platform = os.environ.get("PYOPENGL_PLATFORM")
    wanted = [platform] if platform in ("egl", "osmesa") else ["egl", "osmesa"]
    reasons = []
    for name in wanted:
        try:
            # PyOpenGL reads its platform once, at its first import in the process
            os.environ["PYOPENGL_PLATFORM"] = name
            return importlib.import_module(f"mujoco.{name}").GLContext(width, height)
        except (ImportError, AttributeError, RuntimeError, OSError) as error:
            reasons.append(f"{name}: {str(error).splitlines()[0] if str(error) else type(error).__name__}")
            if platform is None:
                os.environ.pop("PYOPENGL_PLATFORM", None)
    raise MissingDependencyError(
        f"no off-screen drawing ({'; '.join(reasons)}): install libegl1 or libosmesa6, or set PYOPENGL_PLATFORM=osmesa"
    )

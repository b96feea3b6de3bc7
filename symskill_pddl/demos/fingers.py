"""How far the fingers of a recorded hand are apart: from the shapes that close on a thing, whatever the joints read.

Joint readings are no opening: those of one hand are 0 when it is shut, those of another half way, and others turn their
fingers. Where both fingers slide from 0 on, as in the Panda's hand, the readings' sum is the opening, to the last bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from symskill_pddl.errors import FormatError
from symskill_pddl.geometry import Array

_SLIDE, _MESH = 2, 7
"""MuJoCo's numbers for this joint and this shape."""
_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
_LEVEL_M = 0.01
"""Shapes that come this near to the height of the grip site, or as near as any, close on things."""


class Fingers:
    """The fingers of a MuJoCo model.

    Parameters
    ----------
    model, data : Any
        MuJoCo's, after `mj_kinematics`: in this state the fingers have to be on two sides of their middle.
    site : int
        The grip site: between the finger tips, z out of the hand.
    joints : sequence of int
        Those that move the fingers.
    moved : sequence of int
        Bodies that they move.

    Attributes
    ----------
    opening : ndarray (3,)
        Unit vector in the site's frame, across z, along which the first finger opens.

    Raises
    ------
    FormatError
        If there are no two sliding fingers, nor shapes on two sides.
    """

    def __init__(self, model: Any, data: Any, site: int, joints: Sequence[int], moved: Sequence[int]) -> None:
        self._model, self._data, self._site = model, data, site
        self._qpos = [int(model.jnt_qposadr[j]) for j in joints]
        ends = np.abs(model.jnt_range[list(joints)]).min(axis=1)
        sliding = len(joints) == 2 and all(model.jnt_type[j] == _SLIDE for j in joints)
        self._sums = sliding and bool((ends < 1e-9).all())
        shapes = [] if self._sums else self._closing(moved)
        if len(shapes) < 2 and not self._sums:
            raise FormatError(
                "only hands of two fingers with boxes or other simple shapes at their tips can be imported, not this one"
            )
        centres = np.array([self._corners(g).mean(axis=0) for g in shapes]).reshape(-1, 3)
        self.opening = self._slides(int(joints[0])) if sliding else self._spread(centres)
        side = (centres - centres.mean(axis=0)) @ self.opening > 0 if len(centres) else np.zeros(0, bool)
        self._far = [g for g, far in zip(shapes, side, strict=True) if far]
        self._near = [g for g, far in zip(shapes, side, strict=True) if not far]
        if not self._sums and not (self._far and self._near):
            raise FormatError("the shapes of the hand's fingers are all on one side")

    def aperture(self) -> float:
        """The opening [m] in the model's present state, after `mj_kinematics`; not negative."""
        if self._sums:
            return float(np.abs(self._data.qpos[self._qpos]).sum())
        low = min((self._corners(g) @ self.opening).min() for g in self._far)
        high = max((self._corners(g) @ self.opening).max() for g in self._near)
        return float(max(low - high, 0.0))

    def _closing(self, moved: Sequence[int]) -> list[int]:
        """The shapes between which things are held: pads, if any is called so, else what is on the height of the grip site."""
        shapes = [
            g for g in range(self._model.ngeom) if self._model.geom_bodyid[g] in moved and self._model.geom_type[g] != _MESH
        ]
        pads = [g for g in shapes if "pad" in str(self._model.geom(g).name)]
        if len(pads) >= 2:
            return pads
        off = {g: max(0.0, self._corners(g)[:, 2].min(), -self._corners(g)[:, 2].max()) for g in shapes}
        return [g for g in shapes if off[g] <= max(_LEVEL_M, min(off.values()))]

    def _corners(self, geom: int) -> Array:
        """Corners (8, 3) of a shape's box in the site's frame."""
        data, site = self._data, self._site
        box = self._model.geom_aabb[geom]
        world = data.geom_xpos[geom] + (box[:3] + _CORNERS * box[3:]) @ data.geom_xmat[geom].reshape(3, 3).T
        return np.asarray((world - data.site_xpos[site]) @ data.site_xmat[site].reshape(3, 3))

    def _slides(self, joint: int) -> Array:
        sign = 1.0 if self._model.jnt_range[joint].sum() >= 0 else -1.0
        return _across(sign * self._data.xaxis[joint] @ self._data.site_xmat[self._site].reshape(3, 3))

    def _spread(self, centres: Array) -> Array:
        """The direction in which shapes (m, 3) lie apart, from the last to the first."""
        flat = (centres - centres.mean(axis=0)) * [1.0, 1.0, 0.0]
        axis = np.linalg.svd(flat)[2][0]
        return _across(axis if flat[0] @ axis >= 0 else -axis)


def _across(v: Array) -> Array:
    """A direction (3,) without its part along z, as a unit vector."""
    v = v * [1.0, 1.0, 0.0]
    return np.asarray(v / np.linalg.norm(v))

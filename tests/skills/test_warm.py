"""Nothing is compiled while a robot moves."""

import subprocess
import sys

import numpy as np
from compiled import forms

from symskill_pddl import control
from symskill_pddl.geometry import Pose
from symskill_pddl.skills import OrientationField, PositionField, Superellipsoids, modulate, rollout
from symskill_pddl.skills.field import Field
from symskill_pddl.skills.lpv import Lpv
from symskill_pddl.skills.mixture import Mixture
from symskill_pddl.skills.pairing import Pairing


def test_warm_imports_all_that_is_compiled():
    told = "import sys; from symskill_pddl.skills import warm; a = 'numba' in sys.modules; warm(); print(a, sorted(sys.modules))"
    before, after = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, check=True).stdout.split(" ", 1)
    assert before == "False"
    assert all(f"'symskill_pddl.skills.{name}'" in after for name in ("kernels", "bending", "hands"))


def test_one_form_fits_every_memory_layout():
    rng, before, found = np.random.default_rng(0), forms(), []
    p, q = rng.normal(size=(4, 3)), rng.normal(size=(4, 4))
    J, M = rng.normal(size=(6, 7)), np.diag(np.linspace(1.5, 0.1, 7))
    gains, P = -np.stack([np.eye(3), 2 * np.eye(3)]), np.diag([1.0, 2.0, 3.0])
    zero, goal = np.zeros(7), np.array([1.0, 0.0, 0.0, 0.0])
    for layout in (
        np.ascontiguousarray,
        np.asfortranarray,
        lambda a: np.moveaxis(np.ascontiguousarray(np.moveaxis(a, -1, 0)), 0, -1),
    ):
        mixture = Mixture(layout(np.concatenate([np.eye(3), 2 * np.eye(3)])), np.ones(6), np.zeros(2))
        lpv = Lpv(mixture, layout(gains), np.ones(2))
        field = Field(PositionField(lpv, zero[:3]), OrientationField(lpv, goal), layout(P), Pairing.none())
        poses = Pose(layout(p), layout(q))
        things = Superellipsoids(poses, layout(0.1 + abs(p)), layout(0.1 * p))
        found.append(
            [
                field.twist(poses),
                rollout(field, poses, 1.0, 0.1).vector(),
                lpv.velocity(layout(p)),
                modulate(layout(p), layout(p[::-1]), things, goal=p[0], locality=2),
                things.levels(p[0]),
                control.PassiveController().torques(zero, zero, layout(J), layout(M), zero, np.ones(6), 0.002),
                control.damping_matrix(layout(M[:6, :6]), np.ones(6)),
            ]
        )
    for other in found[1:]:
        assert all(np.array_equal(a, b) for a, b in zip(found[0], other, strict=True))
    assert forms() == before

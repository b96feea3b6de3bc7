"""RoboCasa's environments: making one for a task and a seed, and what of its physics is changed."""

from __future__ import annotations

import contextlib
import io
from typing import Any

import numpy as np
from numpy.random import Generator

from symskill_pddl.errors import InputError
from symskill_pddl.panda.arm import tune_drives
from symskill_pddl.robocasa import store_cheese
from symskill_pddl.robocasa.backend import load_mujoco, load_robocasa, quick_yaml, reading_assets
from symskill_pddl.robocasa.tasks import LAYOUTS, Split, TaskSpec

FINGERS = ("gripper0_right_finger1_", "gripper0_right_finger2_")
STIFF = (0.004, 1.0)
"""Time constant [s] and damping ratio of what the fingers touch: twice the time of a step is the stiffest that MuJoCo can do."""
ATTEMPTS = 40
"""Kitchens that are drawn until one has what the task is about."""
REACH_M = (0.37, 0.72)
"""How far a thing may be from the arm's axis. RoboCasa's robot may drive, and some things are where it has to; ours stands."""
LOW_M = 0.07
"""How high a thing may be that is carried: the fingers are 4.5 cm long."""


def draw(spec: TaskSpec, rng: Generator, split: Split) -> Any:
    """An environment of RoboCasa, reset: a kitchen of the split that has what the task is about.

    Raises
    ------
    InputError
        None was found.
    """
    for _ in range(ATTEMPTS):
        layout, style = int(rng.choice(LAYOUTS[split])), int(rng.choice(spec.styles))
        env = make(spec, layout, style, int(rng.integers(2**31)))
        if env is not None:
            return env
    raise InputError(f"no kitchen of RoboCasa with what task '{spec.name}' is about in {ATTEMPTS} draws")


def make(spec: TaskSpec, layout: int, style: int, seed: int) -> Any | None:
    """The environment of a task in one kitchen, reset, or None if the kitchen has no such fixture, or things are out of reach."""
    robosuite, _ = load_robocasa()
    from robocasa.models.fixtures import FixtureType

    store_cheese.register()
    options = {
        key: getattr(FixtureType, value.split(".")[1]) if isinstance(value, str) and value.startswith("FixtureType.") else value
        for key, value in spec.options.items()
    }
    with contextlib.redirect_stdout(io.StringIO()), quick_yaml(), reading_assets():
        env = robosuite.make(
            spec.env,
            robots="PandaOmron",
            has_renderer=False,
            has_offscreen_renderer=False,
            use_camera_obs=False,
            ignore_done=True,
            control_freq=20,
            layout_ids=[layout],
            style_ids=[style],
            seed=seed,
            **options,
        )
        look_up = env._setup_kitchen_references

        def checked() -> None:
            # RoboCasa looks for the fixture, goes on with None if there is none, and fails much later
            look_up()
            part = getattr(env, spec.part)
            if part is None or (spec.part == "cab" and not part.door_joint_names):
                raise _NoSuchFixtureError

        env._setup_kitchen_references = checked
        try:
            env.reset()
        except _NoSuchFixtureError:
            return None
    return env if all(_within_reach(env, name) for name in spec.carried) and all(_low(env, n) for n in spec.carried[:1]) else None


def _low(env: Any, name: str) -> bool:
    """Whether the palm has room above a thing when the fingers are about its middle."""
    return bool(np.ptp(env.objects[name].get_bbox_points(), axis=0)[2] < LOW_M)


def _within_reach(env: Any, name: str) -> bool:
    """Whether a thing can be had without driving there."""
    data = env.sim.data
    away = np.linalg.norm(data.body_xpos[env.obj_body_id[name]][:2] - data.get_body_xpos("robot0_link0")[:2])
    return bool(REACH_M[0] < away < REACH_M[1])


class _NoSuchFixtureError(Exception):
    """A kitchen lacks what a task is about."""


def tune(model: Any) -> None:
    """Change what stands in the way of grasps that hold and of episodes in reasonable time; nothing that a judge looks at.

    The hand gets the drives that the real one has, which robosuite halves, and targets behind the closed position, without which
    a thin bar is hardly held. Its fingers are stiff: with MuJoCo's usual softness they sink into a bar until they meet. Fixtures
    no longer touch each other: what is shut lies in its joint's stop, and a hundred contacts between doors and frames are two
    thirds of the time of a step.
    """
    mujoco = load_mujoco()
    tune_drives(model)
    for g in range(model.ngeom):
        if model.geom(g).name.startswith(FINGERS):
            model.geom_solref[g], model.geom_priority[g] = STIFF, 1
    free = mujoco.mjtJoint.mjJNT_FREE
    loose_roots = {int(b) for b, kind in zip(model.jnt_bodyid, model.jnt_type, strict=True) if kind == free}
    for g in range(model.ngeom):
        root = int(model.body_rootid[model.geom_bodyid[g]])
        robot = model.body(root).name.startswith(("robot0", "mobilebase0"))
        if not robot and root not in loose_roots and model.geom_contype[g]:
            model.geom_contype[g], model.geom_conaffinity[g] = 0, 1

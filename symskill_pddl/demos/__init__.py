"""Demonstrations: the type, its file, and importers of other recordings. h5py and mujoco are imported when first used."""

from symskill_pddl.demos.demo import Demo, extent_conflicts, merged_extents
from symskill_pddl.demos.hdf5 import decode_demos, encode_demos, is_ours, load_demos, save_demos
from symskill_pddl.demos.noise import Jitter, freezes, jitter, without_freezes
from symskill_pddl.demos.robosuite_import import import_robosuite
from symskill_pddl.demos.truth import Move, Truth, load_truths

__all__ = [
    "Demo",
    "Jitter",
    "Move",
    "Truth",
    "decode_demos",
    "encode_demos",
    "extent_conflicts",
    "freezes",
    "import_robosuite",
    "is_ours",
    "jitter",
    "load_demos",
    "load_truths",
    "merged_extents",
    "save_demos",
    "without_freezes",
]

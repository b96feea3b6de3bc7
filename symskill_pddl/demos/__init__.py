"""Demonstrations: the type, its file, and importers of other recordings. h5py and mujoco are imported when first used."""

from symskill_pddl.demos.demo import Demo, merged_extents
from symskill_pddl.demos.hdf5 import decode_demos, encode_demos, load_demos, save_demos
from symskill_pddl.demos.robosuite_import import import_robosuite

__all__ = ["Demo", "decode_demos", "encode_demos", "import_robosuite", "load_demos", "merged_extents", "save_demos"]

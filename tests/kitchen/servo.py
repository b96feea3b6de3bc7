"""What the tests steer the hand with: a proportional servo at 20 Hz, as slow and simple as a learned skill's last centimetres."""

import numpy as np

from symskill_pddl.geometry import quat_conjugate, quat_log, quat_multiply, rotation_distance
from symskill_pddl.scene import Command


def servo(kitchen, target, close, periods, gain=2.0, speed=0.2):
    """Drive the hand to a pose; the errors left, in metres and radians."""
    for _ in range(periods):
        T = kitchen.observe().T_world_ee
        v = gain * (target.p - T.p)
        w = gain * quat_log(quat_multiply(target.q, quat_conjugate(T.q)))
        v *= min(1.0, speed / max(np.linalg.norm(v), 1e-9))
        w *= min(1.0, 1.0 / max(np.linalg.norm(w), 1e-9))
        kitchen.step(Command.of(v, w, close))
    T = kitchen.observe().T_world_ee
    return np.linalg.norm(target.p - T.p), float(rotation_distance(target, T))

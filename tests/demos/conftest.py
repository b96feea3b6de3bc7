from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from symskill_pddl.demos import Demo
from symskill_pddl.geometry import Pose


def make_demo(**changes: Any) -> Demo:
    """Five samples of one cheese above one counter; every argument can be replaced."""
    n = 5
    values: dict[str, Any] = {
        "name": "demo_0",
        "source": "kitchen",
        "task": "StoreCheese",
        "times": np.arange(n) * 0.05,
        "T_world_ee": Pose.from_rotvec(np.linspace(0, 1, 3 * n).reshape(n, 3), np.full((n, 3), 0.1)),
        "aperture": np.full(n, 0.08),
        "gripper_closed": np.arange(n) > 2,
        "objects": {"cheese": "food", "counter": "counter"},
        "T_world_objects": Pose.from_rotvec(np.linspace(-1, 1, 6 * n).reshape(n, 2, 3), np.full((n, 2, 3), -0.2)),
        "extents": {"food": (0.03, 0.02, 0.02)},
        "attributes": {"seed": 7, "rate_hz": 20.0, "note": "Käse"},
    }
    return Demo(**{**values, **changes})


@pytest.fixture
def demo() -> Callable[..., Demo]:
    return make_demo

import io

import numpy as np
from PIL import Image
from synthetic import record

from symskill_pddl.learning.vision.frames import SIZE, drawing


def picture(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def test_what_is_marked_is_red_and_moves_from_picture_to_picture():
    (demo,) = record("PnPCabToCounter", 1, faults=False)
    food = next(o for o, t in demo.objects.items() if t == "food")
    first, last = (picture(drawing(demo, i, food)) for i in (0, len(demo) - 1))
    assert first.shape == (SIZE + 20, 2 * SIZE, 3)
    red = [np.argwhere((p[..., 0] > 180) & (p[..., 1] < 80)) for p in (first, last)]
    side = [r[r[:, 1] >= SIZE] for r in red]
    assert all(len(r) > 20 for r in red)
    assert side[1][:, 0].mean() > side[0][:, 0].mean() + 20  # down from the cabinet
    assert drawing(demo, 0, food) == drawing(demo, 0, food)


def test_without_sizes_there_are_still_boxes():
    (demo,) = record("OpenSingleDoor", 1, faults=False, extents=False)
    assert picture(drawing(demo, 3, "door")).std() > 5

from xml.etree import ElementTree

import numpy as np

from symskill_pddl.abstraction import Classifier
from symskill_pddl.geometry import Pose
from symskill_pddl.report import predicate_svg
from symskill_pddl.symbols import Predicate

SPACE = "{http://www.w3.org/2000/svg}"


def classifier():
    cov = np.diag([0.03, 0.01, 0.002]) ** 2
    T = Pose.from_rotvec(np.array([0.1, 0.0, 0.2]), np.zeros(3))
    return Classifier(Predicate("cup-on-tray", ("cup", "tray")), "cup", "tray", T, cov, np.eye(3) * 0.01, 3.0, 3.0, 1.3)


def drawn(**how):
    c = classifier()
    rng = np.random.default_rng(0)
    T = Pose.stack([c.sample(rng) for _ in range(40)] + [Pose.from_rotvec(np.array([0.5, 0.0, 0.2]), np.zeros(3))])
    holds = np.arange(41) < 40
    return ElementTree.fromstring(predicate_svg(c, T, holds, **how))


def test_six_views_with_two_ellipses_each_and_the_points():
    root = drawn(lines=["support: <3> episodes"])
    views = root.findall(f"{SPACE}g")
    assert len(views) == 6
    assert all(len(view.findall(f"{SPACE}polygon")) == 2 for view in views)
    texts = [t.text for t in root.iter(f"{SPACE}text")]
    assert "support: <3> episodes" in texts
    assert any("40 of 41 samples hold" in t for t in texts)
    # the pose that is far away lies beyond the view of its position
    assert len(views[0].findall(f"{SPACE}circle")) == 40


def test_points_that_hold_lie_within_the_drawn_ellipse():
    """A sample of the predicate is inside its ellipsoid, so its shadow is inside the ellipsoid's."""
    for view in drawn().findall(f"{SPACE}g"):
        outline = np.array([[float(v) for v in p.split(",")] for p in view.find(f"{SPACE}polygon").get("points").split()])
        middle = outline.mean(axis=0)
        held = [c for c in view.findall(f"{SPACE}circle") if c.get("fill") == "#0072b2"]
        points = np.array([[float(c.get("cx")), float(c.get("cy"))] for c in held])
        angle = np.arctan2(*(outline - middle).T[::-1])
        radius = np.linalg.norm(outline - middle, axis=1)
        order = np.argsort(angle)
        allowed = np.interp(np.arctan2(*(points - middle).T[::-1]), angle[order], radius[order], period=2 * np.pi)
        assert np.all(np.linalg.norm(points - middle, axis=1) <= allowed + 1.5)

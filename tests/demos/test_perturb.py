import numpy as np
import pytest
from synthetic import record

from symskill_pddl.demos import Move, Truth
from symskill_pddl.demos.perturb import CLEAR_M, with_approaches_again, with_distractors, with_noise


@pytest.fixture(scope="module")
def shown():
    (demo,) = record("PnPCabToCounter", 1, 4, faults=False)
    food = next(o for o, t in demo.objects.items() if t == "food" and np.ptp(demo.pose(o).p[:, 2]) > 0.1)
    far = np.linalg.norm(demo.pose(food).p - demo.pose(food).p[0], axis=-1) > 0.01
    start, stop = (
        demo.times[np.argmax(far)],
        demo.times[len(far) - 1 - np.argmax(np.linalg.norm(np.diff(demo.pose(food).p, axis=0), axis=-1)[::-1] > 0.01)],
    )
    relations = {("at", food, "cabinet"): ~far, ("open", "door", "cabinet"): np.ones(len(demo), bool)}
    return demo, Truth((Move(food, float(start), float(stop), "cabinet", "counter"),), relations)


def test_noise_is_as_large_as_asked_and_mostly_constant(shown):
    demo, truth = shown
    noisy, same = with_noise(demo, truth, 0.02, np.random.default_rng(0))
    off = noisy.T_world_objects.p - demo.T_world_objects.p
    assert same is truth
    assert 0.005 < np.abs(off.mean(axis=0)).mean() < 0.04
    assert off.std(axis=0).mean() == pytest.approx(0.001, rel=0.2)
    assert np.array_equal(noisy.T_world_ee.p, demo.T_world_ee.p)
    again, _ = with_noise(demo, truth, 0.02, np.random.default_rng(0))
    assert np.array_equal(again.T_world_objects.p, noisy.T_world_objects.p)


def test_things_stand_about_out_of_the_way_at_the_height_of_others(shown):
    demo, truth = shown
    more, known = with_distractors(demo, truth, 3, np.random.default_rng(1))
    new = [o for o in more.objects if o not in demo.objects]
    assert list(more.objects)[: len(demo.objects)] == list(demo.objects)
    assert [more.objects[o] for o in new] == ["bottle", "food", "mug"][: len(new)]
    for o in new:
        assert np.ptp(more.pose(o).p, axis=0).max() == 0.0
        assert np.linalg.norm(demo.T_world_ee.p - more.pose(o).p[0], axis=-1).min() > CLEAR_M
        assert known.relations["at", o, "cabinet"].all()


def test_an_approach_is_done_again_and_the_truth_follows(shown):
    demo, truth = shown
    longer, later = with_approaches_again(demo, truth, 2)
    (old,), (new,) = truth.moves, later.moves
    added = len(longer) - len(demo)
    assert 30 < added <= 100
    assert new.start_s - old.start_s == pytest.approx(added * 0.05)
    assert new.stop_s - old.stop_s == pytest.approx(added * 0.05)
    assert all(len(v) == len(longer) for v in later.relations.values())
    i, j = np.searchsorted(demo.times, old.start_s), np.searchsorted(longer.times, new.start_s)
    assert np.array_equal(demo.pose(old.obj).p[i:], longer.pose(old.obj).p[j:])
    assert np.allclose(np.diff(longer.times), 0.05)


def test_nothing_to_do_leaves_all_as_it_is(shown):
    demo, _ = shown
    empty = Truth(())
    assert with_approaches_again(demo, empty, 2)[0] is demo
    assert list(with_distractors(demo, empty, 2, np.random.default_rng(0))[0].objects) == list(demo.objects)

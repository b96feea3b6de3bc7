from dataclasses import replace

import numpy as np
import pytest
from fake_world import CABINET, COUNTER, DOWN, OBJECTS, FakeWorld, at, atoms, make_library

from symskill_pddl.abstraction import abstract
from symskill_pddl.execution.belief import Belief
from symskill_pddl.execution.recovery import (
    FailureMemory,
    backed_off,
    capped,
    goal_shift,
    key_of,
    later_leg,
    near,
    nearest_symbols,
    other_face,
    servo,
    way_back,
    way_in,
)
from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.symbols import GroundOperator

LIBRARY = make_library()
BY_NAME = {c.predicate.name: c for c in LIBRARY.classifiers}


def step(name, *args):
    domain = LIBRARY.domain()
    return domain.ground(domain.operator(name), args, OBJECTS)


def binding(ground: GroundOperator):
    return dict(zip((p.name for p in LIBRARY.learned(ground.name).operator.parameters), ground.args, strict=True))


def shift_of(ground, scene, radius, seed=0):
    learned = LIBRARY.learned(ground.name)
    rng = np.random.default_rng(seed)
    return goal_shift(ground, LIBRARY.skills[learned.skill], binding(ground), LIBRARY.classifiers, scene, rng, radius)


def test_failures_raise_costs_until_a_success():
    key, other = ("pick", ("x",)), ("pick", ("y",))
    memory = FailureMemory().blame(key).blame(key).blame(other)
    assert memory.extra_costs(10.0) == {key: 20.0, other: 10.0}
    assert memory.clear(key).extra_costs(10.0) == {other: 10.0}
    assert memory.count(key) == 2
    assert FailureMemory().count(key) == 0


class TestShift:
    def test_a_place_brings_the_object_to_a_sampled_pose_with_the_present_grasp(self):
        world = FakeWorld(ee=Pose([0.1, 0.2, 0.5], DOWN))
        # held 2 cm off: the skill's goal for the hand would put the food 2 cm off
        world.cheese = world.ee @ at(0.02, 0.0, 0.01)
        scene, ground = world.observe(), step("place-in-cabinet", "cheese", "cabinet", "door")
        frame, shift = shift_of(ground, scene, 1e-9)
        assert frame == "?cabinet"
        goal = LIBRARY.skills["place-cabinet"].phases[0].field.T_goal
        T_food_ee = scene.pose("cheese").inverse() @ scene.T_world_ee
        T_cabinet_food = shift @ goal @ T_food_ee.inverse()
        assert np.allclose(T_cabinet_food.p, BY_NAME["food-in-cabinet"].T_mean.p, atol=1e-6)
        assert rotation_distance(T_cabinet_food, BY_NAME["food-in-cabinet"].T_mean) < 1e-6

    def test_a_place_is_sampled_around_where_the_skill_was_shown_it(self):
        """The predicate may be as wide as a counter: its mean is no place that the skill knows."""
        world = FakeWorld(ee=Pose([0.1, 0.2, 0.5], DOWN))
        ground = step("place-on-counter", "cheese", "counter")
        learned = LIBRARY.skills["place-counter"].phases[0].field.T_goal
        classifier = BY_NAME["food-on-counter"]
        aside = classifier.T_mean.p + 0.6 * classifier.enter_p * np.sqrt(np.diag(classifier.cov_p)) * [1.0, 0.0, 0.0]
        world.cheese = world.ee @ (Pose(aside, classifier.T_mean.q).inverse() @ learned).inverse()
        _, shift = shift_of(ground, world.observe(), 1e-9)
        assert np.allclose(shift.p, 0.0, atol=1e-6)
        assert rotation_distance(shift, Pose.identity()) < 1e-6

    @pytest.mark.parametrize("seed", range(5))
    def test_the_sampled_pose_satisfies_the_effect(self, seed):
        world = FakeWorld(ee=Pose([0.1, 0.2, 0.5], DOWN))
        world.cheese = world.ee @ at(0.0, 0.0, 0.0)
        scene, ground = world.observe(), step("place-on-counter", "cheese", "counter")
        _, shift = shift_of(ground, scene, 0.9, seed)
        goal = LIBRARY.skills["place-counter"].phases[0].field.T_goal
        T_counter_food = shift @ goal @ (scene.pose("cheese").inverse() @ scene.T_world_ee).inverse()
        assert BY_NAME["food-on-counter"].holds(T_counter_food)

    def test_a_pick_moves_by_the_deviation_of_a_hand_pose(self):
        frame, shift = shift_of(step("pick-from-counter", "cheese", "counter"), FakeWorld().observe(), 1.0)
        assert frame == "?food"
        assert BY_NAME["gripper-holds-food"].holds(shift @ BY_NAME["gripper-holds-food"].T_mean)
        assert np.linalg.norm(shift.p) > 1e-3

    def test_an_open_hand_has_no_grasp_to_compose_with(self):
        """A lever under a finger is elsewhere under it at the end of a push: the goal moves as the lever's sample does."""
        skill = LIBRARY.skills["open-door"]
        pushing = replace(skill, phases=tuple(replace(p, close_gripper=False) for p in skill.phases[:3]))
        ground, world = step("open-door", "door", "cabinet"), FakeWorld()
        frame, shift = goal_shift(
            ground, pushing, binding(ground), LIBRARY.classifiers, world.observe(), np.random.default_rng(0), 1e-9
        )
        assert frame == "?cabinet"
        assert np.allclose(shift.p, 0.0, atol=1e-6)
        assert rotation_distance(shift, Pose.identity()) < 1e-6

    def test_the_radius_bounds_the_sample(self):
        ground, scene = step("pick-from-counter", "cheese", "counter"), FakeWorld().observe()
        sizes = [np.linalg.norm(shift_of(ground, scene, radius)[1].p) for radius in (0.01, 1.0)]
        assert sizes[0] <= 0.01 * 0.03 + 1e-12
        assert sizes[0] < sizes[1]

    def test_no_effect_in_any_frame_of_the_skill(self):
        ground = GroundOperator("pick-from-counter", ("cheese", "counter"), frozenset(), atoms("gripper-open"), frozenset())
        assert shift_of(ground, FakeWorld().observe(), 1.0) is None


class TestNearest:
    def nearest(self, world, objects=tuple(OBJECTS)):
        scene = world.observe()
        return nearest_symbols(scene, abstract(scene, LIBRARY.classifiers), LIBRARY.classifiers, objects)

    def test_a_door_between_its_symbols(self):
        found = self.nearest(FakeWorld(angle=0.5))
        assert list(found) == ["door"]
        assert [a.atom.predicate for a in found["door"]] == ["door-closed", "door-open"]
        assert found["door"][0].margin < 0
        assert self.nearest(FakeWorld(angle=1.1))["door"][0].atom.predicate == "door-open"

    def test_an_object_in_no_place(self):
        world = FakeWorld(cheese=Pose(COUNTER + np.array([0.3, 0, 0.03]), [1.0, 0, 0, 0]))
        assert [a.atom.predicate for a in self.nearest(world)["cheese"]] == ["food-on-counter", "food-in-cabinet"]

    def test_all_in_their_places(self):
        assert self.nearest(FakeWorld()) == {}

    def test_what_is_held_is_not_out_of_place(self):
        world = FakeWorld(ee=Pose(CABINET + np.array([0, 0, 0.3]), DOWN), cheese=at(*(CABINET + np.array([0, 0, 0.3]))))
        assert self.nearest(world) == {}

    def test_what_moves_is_left_out(self):
        assert self.nearest(FakeWorld(angle=0.5), objects=("cheese", "cabinet")) == {}


class TestBeginOtherwise:
    SKILL = LIBRARY.skills["pick"]

    def test_the_way_in_is_the_first_of_two_phases_with_the_same_fingers(self):
        scene = FakeWorld().observe()
        np.testing.assert_allclose(
            way_in(self.SKILL, {"?food": "cheese"}, scene).p, scene.pose("cheese").p + np.array([0, 0, 0.1])
        )
        assert way_in(self.SKILL, {"?food": "cheese"}, FakeWorld(closed=True).observe()) is None
        assert way_in(replace(self.SKILL, phases=self.SKILL.phases[1:]), {"?food": "cheese"}, scene) is None

    def test_a_leading_phase_may_be_left_out_but_not_the_approach(self):
        assert later_leg(self.SKILL, 0) == 0
        carry = LIBRARY.skills["open-door"]  # three phases closed, one open
        assert [later_leg(carry, stage) for stage in range(4)] == [1, 0, 0, 0]

    def test_every_other_time(self):
        belief, pick = Belief(frozenset()), step("pick-from-counter", "cheese", "counter")
        belief.held_up(pick, 1)
        assert belief.blocked == {key_of(pick): 1}
        belief.held_up(pick, 0)
        assert belief.blocked == {}


class TestOtherFace:
    LYING = Pose.from_rotvec(COUNTER + np.array([0.02, 0, 0.03]), [np.pi / 2, 0, 0]) @ Pose.from_rotvec(np.zeros(3), [0, 0.2, 0])

    def found(self, pose, half=(0.02, 0.02, 0.02)):
        return other_face(FakeWorld(cheese=pose).observe(), "cheese", half, LIBRARY.classifiers)

    def test_a_cube_that_fell_over_is_turned_upright(self):
        q, assumption = self.found(self.LYING)
        assert assumption.atom == next(iter(atoms("food-on-counter cheese counter")))
        assert assumption.margin > 0
        turned = self.LYING @ Pose(np.zeros(3), q)
        np.testing.assert_allclose(turned.rotation_matrix()[2, 2], 1.0, atol=1e-9)
        # of the four ways to stand upright the one nearest to what was shown
        assert rotation_distance(turned, Pose(turned.p, [1.0, 0, 0, 0])) == pytest.approx(0.2)

    def test_what_stands_as_shown_is_left_alone(self):
        assert self.found(Pose(self.LYING.p, [1.0, 0, 0, 0])) is None

    def test_a_long_thing_on_its_end_is_no_other_face_of_the_same_box(self):
        assert self.found(self.LYING, (0.02, 0.02, 0.06)) is None
        assert self.found(self.LYING, (0.06, 0.02, 0.024)) is not None

    def test_nothing_is_known_of_what_is_never_a_child(self):
        assert other_face(FakeWorld().observe(), "cabinet", (0.1, 0.1, 0.1), LIBRARY.classifiers) is None


def test_servo_goes_straight_to_the_target():
    a, b = Pose.from_rotvec([0.1, 0.2, 0.3], [0.3, 0, 0]), Pose.from_rotvec([0.2, 0.1, 0.3], [0, 0.5, 1.0])
    T = a
    for _ in range(200):
        twist = servo(T, b, gain=4.0, max_speed=0.2, max_turn=1.0)
        assert np.linalg.norm(twist[:3]) <= 0.2 + 1e-12
        assert np.linalg.norm(twist[3:]) <= 1.0 + 1e-12
        turned = Pose.from_rotvec(np.zeros(3), twist[3:] * 0.05)
        T = Pose(T.p + twist[:3] * 0.05, (turned @ Pose(np.zeros(3), T.q)).q)
    assert near(T, b, distance_m=1e-4, angle_rad=1e-4)
    assert not near(a, b, distance_m=0.01, angle_rad=9.0)
    assert not near(a, b, distance_m=9.0, angle_rad=0.01)


def test_caps_scale_and_never_turn():
    twist = np.array([3.0, 4.0, 0.0, 0.0, 0.0, 1.0])
    slow = capped(twist, 1.0, 10.0)
    assert np.allclose(slow, twist / 5.0)
    assert np.allclose(capped(twist, 10.0, 10.0), twist)
    assert np.allclose(capped(twist, 10.0, 0.1), twist / 10.0)


def test_way_back():
    path = [Pose([x, 0, 0], [1.0, 0, 0, 0]) for x in np.linspace(0, 1, 201)]
    back = way_back(path, 0.095, spacing_m=0.02)
    assert [round(float(T.p[0]), 6) for T in back] == [0.98, 0.96, 0.94, 0.92, 0.9]
    assert way_back([], 1.0) == ()
    assert way_back(path, np.inf)[-1].p[0] < 0.02


def test_backing_off_is_against_the_approach():
    assert np.allclose(backed_off(Pose([0, 0, 0.1], DOWN), 0.05).p, [0, 0, 0.15])

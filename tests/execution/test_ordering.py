"""What has been begun is finished first."""

from dataclasses import replace

from symskill_pddl.execution.ordering import one_by_one
from symskill_pddl.symbols import Atom, GroundOperator

EMPTY, FREE = frozenset(), Atom("gripper-open")


def step(name, *args, pre=(), add=(), delete=()):
    sets = {
        key: frozenset(Atom(text, ("it",)) for text in texts) for key, texts in (("pre", pre), ("add", add), ("delete", delete))
    }
    return GroundOperator(name, args, **sets, maintain=EMPTY, absent=EMPTY, cost=1.0)


OPEN = step("open", "door", add=["open"], delete=["shut"])
TAKE = step("take", "cheese", "door", pre=["open"], add=["taken"])
SHUT = step("shut", "door", pre=["open"], add=["shut"], delete=["open"])
COOK = step("cook", "egg", add=["cooked"])
GOAL = frozenset(Atom(text, ("it",)) for text in ("taken", "cooked", "shut"))


def test_a_door_is_not_left_open_while_something_else_is_done():
    found = one_by_one((OPEN, COOK, TAKE, SHUT), SHUT.add, GOAL)
    assert found == (OPEN, TAKE, SHUT, COOK)


def test_a_door_that_an_earlier_plan_opened_is_shut_first():
    goal = COOK.add | SHUT.add
    assert one_by_one((COOK, SHUT), OPEN.add, goal) == (COOK, SHUT)
    assert one_by_one((COOK, SHUT), OPEN.add, goal, frozenset({"door"})) == (SHUT, COOK)


def test_what_cannot_be_ordered_otherwise_stays():
    first = replace(COOK, add=COOK.add | {Atom("may-open", ("it",))})
    door = replace(OPEN, pre=frozenset({Atom("may-open", ("it",))}))
    assert one_by_one((first, door, TAKE, SHUT), SHUT.add, GOAL) == (first, door, TAKE, SHUT)
    assert one_by_one((), EMPTY, EMPTY) == ()


def test_the_hand_is_emptied_before_it_takes_something_else():
    def pick(name):
        return GroundOperator(
            "pick", (name, "table"), frozenset({FREE}), frozenset({Atom("held", (name,))}), frozenset({FREE}), EMPTY
        )

    def place(name, where):
        held = frozenset({Atom("held", (name,))})
        return GroundOperator("place", (name, where), held, frozenset({Atom("in", (name, where)), FREE}), held, EMPTY)

    steps = (pick("egg"), place("egg", "pan"), OPEN, pick("bun"), place("bun", "pan"), TAKE, SHUT)
    goal = frozenset({Atom("in", ("egg", "pan")), Atom("in", ("bun", "pan")), *TAKE.add, *SHUT.add})
    found = one_by_one(steps, frozenset({FREE}) | SHUT.add, goal)
    assert found == (*steps[:2], *steps[3:5], OPEN, TAKE, SHUT)


def test_a_plan_of_a_thousand_steps():
    """No recursion: each step needs what the one before it made."""
    chain = tuple(step("go", f"o{i}", pre=[f"at{i}"], add=[f"at{i + 1}"], delete=[f"at{i}"]) for i in range(1000))
    assert one_by_one(chain, chain[0].pre, chain[-1].add) == chain

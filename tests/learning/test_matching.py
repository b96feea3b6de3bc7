"""Matching objects with variables: exact where atoms speak of one of them, in time that grows as a polynomial."""

from itertools import permutations

from hypothesis import given
from hypothesis import strategies as st

from symskill_pddl.learning.matching import Side, best_match
from symskill_pddl.symbols import Atom


def shared(lifted, ground, match):
    return sum((tag, atom.substitute(match)) in lifted.atoms for tag, atom in ground.atoms)


def best_of_all(lifted, ground, fixed):
    variables, objects = sorted(lifted.types), sorted(ground.types)
    padded = [*objects, *[None] * max(len(variables) - len(objects), 0)]
    return max(
        shared(lifted, ground, {**fixed, **{o: v for o, v in zip(pick, variables, strict=True) if o is not None}})
        for pick in permutations(padded, len(variables))
    )


def unary(names, argument):
    atom = st.builds(
        lambda tag, p, x: (tag, Atom(p, (x, argument))),
        st.sampled_from(["pre", "during"]),
        st.sampled_from(["in", "on", "at"]),
        st.sampled_from(names),
    )
    return st.frozensets(atom, max_size=10)


@given(unary(["?a", "?b", "?c", "?d"], "?box"), unary(["p", "q", "r"], "box"))
def test_as_good_as_trying_all_where_atoms_speak_of_one_context_object(common, atoms):
    lifted, ground = Side(common, dict.fromkeys(["?a", "?b", "?c", "?d"], "food")), Side(atoms, dict.fromkeys("pqr", "food"))
    match = best_match(lifted, ground, {"box": "?box"})
    assert shared(lifted, ground, match) == best_of_all(lifted, ground, {"box": "?box"})
    assert len(set(match.values())) == len(match)


def test_chains_of_context_objects_are_followed():
    # a tower of foods on the moved one: only the neighbours tell them apart
    def tower(names):
        return frozenset(("pre", Atom("on", pair)) for pair in zip(names[1:], names, strict=False))

    lifted = Side(tower(["?x", "?a", "?b", "?c", "?d"]), dict.fromkeys(["?a", "?b", "?c", "?d"], "food"))
    ground = Side(tower(["x", "q", "t", "p", "s"]), dict.fromkeys("qtps", "food"))
    assert best_match(lifted, ground, {"x": "?x"}) == {"x": "?x", "q": "?a", "t": "?b", "p": "?c", "s": "?d"}


def test_two_types_that_meet_in_an_atom():
    # the lid of the pan that stands on the stove, among three lids and three pans
    def scene(stove, pans, lids):
        return frozenset(
            {("pre", Atom("on", (pans[1], stove))), *(("pre", Atom("lid-on", pair)) for pair in zip(lids, pans, strict=True))}
        )

    lifted = Side(
        scene("?stove", ["?p", "?p-2", "?p-3"], ["?l", "?l-2", "?l-3"]),
        {**dict.fromkeys(["?p", "?p-2", "?p-3"], "pan"), **dict.fromkeys(["?l", "?l-2", "?l-3"], "lid")},
    )
    ground = Side(
        scene("stove", ["c", "a", "b"], ["z", "y", "x"]), {**dict.fromkeys("abc", "pan"), **dict.fromkeys("xyz", "lid")}
    )
    match = best_match(lifted, ground, {"stove": "?stove"})
    assert (match["a"], match["y"]) == ("?p-2", "?l-2")
    assert shared(lifted, ground, match) == 4


def test_sixty_objects_of_one_type_keep_their_order_where_nothing_tells_them_apart():
    names = [f"o{i:02}" for i in range(60)]
    lifted = Side(frozenset(("pre", Atom("on", (f"?{n}", "?table"))) for n in names), {f"?{n}": "food" for n in names})
    ground = Side(frozenset(("pre", Atom("on", (n, "table"))) for n in names), dict.fromkeys(names, "food"))
    match = best_match(lifted, ground, {"table": "?table"})
    assert match == {"table": "?table"} | {n: f"?{n}" for n in names}

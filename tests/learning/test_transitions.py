"""Atoms of recordings."""

import numpy as np

from symskill_pddl.learning.transitions import never_shared
from symskill_pddl.symbols import Atom


def test_two_at_a_time_are_noticed_in_any_frame_of_any_recording():
    def truth(egg, ham, plate="dish"):
        rows = {Atom("on-plate", ("egg", "dish")): egg, Atom("on-plate", ("ham", plate)): ham, Atom("holds", ("egg",)): [1, 1, 1]}
        return {atom: np.array(row, bool) for atom, row in rows.items()}

    one_after_the_other = truth([1, 1, 0], [0, 0, 1])
    assert never_shared([one_after_the_other, truth([1, 1, 1], [1, 1, 1], "other-dish")]) == {"on-plate"}
    assert never_shared([one_after_the_other, truth([1, 1, 0], [0, 1, 1])]) == frozenset()
    assert never_shared([]) == frozenset()

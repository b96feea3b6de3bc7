"""``python -m symskill_pddl.cli``: the same as the `symskill` program."""

from symskill_pddl.cli.app import main

main()

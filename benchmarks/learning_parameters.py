"""Write the table of parameters into docs/learning.md: ``python benchmarks/learning_parameters.py``."""

from __future__ import annotations

from pathlib import Path

from symskill_pddl.cli.settings import parameters, table
from symskill_pddl.files import write_atomic

PAGE = Path(__file__).parent.parent / "docs" / "learning.md"
MARK = "<!-- parameters: made by benchmarks/learning_parameters.py -->\n"


def main() -> None:
    """All below the mark is replaced."""
    head = PAGE.read_text(encoding="utf-8").split(MARK)[0]
    write_atomic(PAGE, (head + MARK + table(parameters())).encode())


if __name__ == "__main__":
    main()

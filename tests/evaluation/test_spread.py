"""Where episodes are run makes no difference."""

from __future__ import annotations

import builtins
from pathlib import Path
from typing import Any

import pytest

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.evaluation.spread import Processes, Ray
from symskill_pddl.evaluation.suite import ERROR, Suite, run_suite
from symskill_pddl.library import Library


@pytest.mark.simulation
def test_a_ray_cluster_gives_the_same_results(tmp_path: Path) -> None:
    pytest.importorskip("ray", reason="Ray is not installed (pip install 'symskill-pddl[ray]'), so its cluster is not tried")
    # an empty library has no goals: every episode is set up, and fails with its reason
    Library((), (), (), {}).save(tmp_path)
    suite = Suite(("StoreCheese",), trials=2, seed=3)
    told: list[tuple[str, int]] = []
    alone = run_suite(Library.load, tmp_path, suite, pool=Processes(1))
    spread = run_suite(
        Library.load, tmp_path, suite, pool=Ray("local", jobs=2), on_episode=lambda task, e: told.append((task, e.seed))
    )
    assert spread.dumps() == alone.dumps()
    assert spread.tasks[0].failures == {ERROR: 2}
    assert sorted(told) == sorted(suite.episodes)


def test_a_cluster_that_is_not_there() -> None:
    pytest.importorskip("ray", reason="Ray is not installed (pip install 'symskill-pddl[ray]'), so its errors are not tried")
    with pytest.raises(InputError, match=r"no Ray cluster at 'ray://127\.0\.0\.1:1'"):
        list(Ray("ray://127.0.0.1:1").run(lambda: None, [("StoreCheese", 1)]))  # type: ignore[arg-type, return-value]


def test_without_ray_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def refuse(name: str, *rest: Any, **more: Any) -> Any:
        if name == "ray":
            raise ImportError("no")
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(MissingDependencyError, match=r"pip install 'symskill-pddl\[ray\]'"):
        list(Ray("local").run(lambda: None, [("StoreCheese", 1)]))  # type: ignore[arg-type, return-value]


def test_nothing_to_do_starts_nothing() -> None:
    def begin() -> Any:
        raise AssertionError("nothing was to be loaded")

    assert list(Processes(4).run(begin, [])) == []
    assert list(Ray("nowhere").run(begin, [])) == []

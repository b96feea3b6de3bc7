from importlib import import_module
from pathlib import Path

import numpy as np

from symskill_pddl.execution.timing import STAGES, Spread, percentile, spreads


def test_percentiles_are_of_the_nearest_rank():
    values = [5.0, 1.0, 2.0, 4.0, 3.0]
    assert [percentile(values, p) for p in (0, 20, 21, 50, 95, 100)] == [1, 1, 2, 3, 5, 5]


def test_a_tick_is_the_sum_of_its_stages_and_of_nothing_else():
    ticks = [{"world": 9.0, "observe": 0.1, "abstract": 0.2}, {"world": 8.0, "abstract": 0.4, "trace": 1.0}]
    found = spreads(ticks, [0.5, 0.02, 0.01])
    assert list(found) == ["tick", "observe", "abstract", "trace", "world", "first plan", "replanning"]
    assert found["tick"] == Spread(2, 0.3, 0.4, 0.4)
    assert found["world"] == Spread(2, 8.0, 9.0, 9.0)
    assert found["first plan"] == Spread(1, 500.0, 500.0, 500.0)
    assert found["replanning"] == Spread(2, 10.0, 20.0, 20.0)


def test_what_was_not_measured_is_left_out():
    assert spreads([], []) == {}
    assert set(spreads([{"abstract": 1.0}], [])) == {"tick", "abstract"}
    assert len(STAGES) == len(set(STAGES))


def test_the_benchmark_of_a_tick_still_fits_the_code(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "benchmarks")
    tick = import_module("tick")
    assert len(tick.objects(20)) == 20
    assert tick.scene_of(5, np.random.default_rng(0)).observe().objects == tick.objects(5)

import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.skills import FitConfig


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"period_s": 0.0}, "period_s"),
        ({"rate_hz": 4.0}, "rate_hz"),
        ({"gain_hz": 30.0}, "gain_hz"),
        ({"max_condition": 0.5}, "max_condition"),
        ({"tolerance_m": float("nan")}, "tolerance_m"),
    ],
)
def test_settings_that_make_no_sense_are_refused(setting, message):
    with pytest.raises(InputError, match=message):
        FitConfig(**setting)

"""Contacts that know time: velocities, temperature, ageing, holds."""

import asperity as asp
import numpy as np
import pytest

THRESHOLDS = asp.Gaussian(1.0, 0.1)
THERMAL = asp.Contacts(THRESHOLDS, temperature=asp.Temperature(0.05, 1.0))
GROWING = asp.Contacts(THRESHOLDS, ageing=asp.Logarithmic(0.02, 1.0))
RANKED = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=asp.FrozenRank(asp.Gaussian(1.0, 0.05), 1.0))


def test_velocity_curves_have_the_values_of_the_theory() -> None:
    # kx̄²/2T = 10 and σ = 0.1; logarithmic growth; frozen rank, which ignores 3e-7 of the newborn law below 0
    assert asp.velocity_curve(THERMAL, [1e-4, 1e-2]) == pytest.approx(
        [0.29806681116, 0.44526255210], abs=1e-9
    )
    assert asp.velocity_curve(GROWING, 1.0) == pytest.approx(0.5122109494, abs=1e-9)
    assert asp.velocity_curve(RANKED, [10.0, 1.0]) == pytest.approx([0.2721367872, 0.3867782523], abs=4e-7)


def test_an_equation_of_contacts_that_know_time_has_a_velocity() -> None:
    theory = asp.MasterEquation(GROWING, velocity=1.0)
    assert theory.velocity == 1.0
    assert theory.steady_state().kinetic_friction == pytest.approx(0.5122109494, abs=1e-9)
    with pytest.raises(
        ValueError, match=r"velocity: expected a velocity above 0, since contacts\.ageing knows time"
    ):
        asp.MasterEquation(GROWING)
    with pytest.raises(ValueError, match="velocity: expected a finite number above 0, got 0"):
        asp.MasterEquation(GROWING, velocity=0.0)


def test_both_solvers_follow_the_same_way() -> None:
    steps = [
        asp.Step(1.0, distance=3.3, points=34),
        asp.Step(hold=10.0, points=3),
        asp.Step(0.5, duration=2.0, points=21),
    ]
    trace = asp.Transport(GROWING).follow(steps)
    assert trace["time"].shape == (34 + 2 + 20,)
    assert trace["position"][-1] == pytest.approx(4.3, abs=1e-12)
    assert set(trace["velocity"]) == {1.0, 0.0, 0.5}
    assert trace["free"] == pytest.approx(0.0, abs=1e-12)
    ensemble = asp.Ensemble(GROWING, size=20_000).follow(steps)
    # 6 standard errors, by chance once in a million; and two contacts: nothing scatters before a first break
    assert np.all(np.abs(ensemble["force"] - trace["force"]) < 6 * ensemble["force_error"] + 1e-4)


def test_a_pull_at_a_velocity_is_a_way_at_one_velocity() -> None:
    pull = asp.MasterEquation(THERMAL, velocity=0.01).pull(3.0, 31)
    trace = asp.Transport(THERMAL).follow([asp.Step(0.01, distance=3.0, points=31)])
    # the tolerance of the transport, 1e-7, with room for its being an estimate
    assert trace["force"] == pytest.approx(pull.force, abs=1e-6)


def test_free_contacts_carry_nothing() -> None:
    contacts = asp.Contacts(THRESHOLDS, delay=0.5)
    assert contacts.delay == 0.5
    steady = asp.velocity_curve(contacts, 2.0)
    # F_k ∫xS/(C + vτ) with C = 1, ∫xS = 0.505
    assert steady == pytest.approx(0.505 / 2.0, abs=1e-9)


def test_rules_are_described() -> None:
    for rule in [
        asp.Temperature(0.05, 2.0, barrier="bell"),
        asp.Smoluchowski(asp.Gaussian(1.0, 0.05), 0.0025),
        asp.FrozenRank(asp.Gaussian(1.0, 0.05), 1.0),
        asp.Logarithmic(0.02, 1.0),
        asp.MeanField(asp.Gaussian(1.0, 0.05), 0.0025),
        asp.Step(1.0, duration=2.0, velocity_to=3.0, pieces=5),
    ]:
        assert eval(repr(rule), {"asperity": asp, **vars(asp)}) == rule
    assert THERMAL.temperature == asp.Temperature(0.05, 1.0)
    assert GROWING.ageing == asp.Logarithmic(0.02, 1.0)
    assert THERMAL.replace(temperature=None).temperature is None


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: asp.Step(), "step: expected one of hold, distance and duration"),
        (
            lambda: asp.Step(-1.0, duration=1.0),
            r"step\.velocity: expected a finite number, 0 or above, got -1",
        ),
        (lambda: asp.Temperature(1.0, 1.0, barrier="high"), "barrier"),  # type: ignore[arg-type]
        (lambda: asp.Transport(THERMAL).follow([]), "steps: expected at least one step"),
    ],
)
def test_wrong_values_are_refused(make: object, message: str) -> None:
    assert callable(make)
    with pytest.raises(ValueError, match=message):
        make()


def test_scenarios_take_rules_and_steps_as_objects() -> None:
    result = asp.run(
        {"contacts": GROWING, "protocol": [asp.Step(1.0, distance=1.0, points=11), asp.Step(hold=1.0)]}
    )
    assert result["force"].shape == (11 + 200,)
    assert np.isnan(result.kinetic_friction)
    assert [step["velocity"] for step in result.summary["steps"]] == [1.0, 0.0]

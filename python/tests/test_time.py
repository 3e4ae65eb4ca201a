"""Time-dependent contacts: velocities, temperature, ageing, holds."""

import copy
import pickle

import asperity as asp
import numpy as np
import pytest

THRESHOLDS = asp.Gaussian(1.0, 0.1)
THERMAL = asp.Contacts(THRESHOLDS, temperature=asp.Temperature(0.05, 1.0))
GROWING = asp.Contacts(THRESHOLDS, ageing=asp.Logarithmic(0.02, 1.0))
RANKED = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=asp.FrozenRank(asp.Gaussian(1.0, 0.05), 1.0))


def test_velocity_curves_have_the_values_of_the_theory() -> None:
    # kx̄²/2T = 10 and σ = 0.1; logarithmic growth; frozen rank, which ignores 3e-7 of the fresh law below 0
    warm = asp.velocity_curve(THERMAL, [1e-4, 1e-2])
    assert warm.kinetic_friction == pytest.approx([0.29806681116, 0.44526255210], abs=1e-9)
    assert asp.velocity_curve(GROWING, 1.0) == pytest.approx(0.5122109494, abs=1e-9)
    ranked = asp.velocity_curve(RANKED, [1.0, 10.0])
    assert ranked.kinetic_friction == pytest.approx([0.3867782523, 0.2721367872], abs=4e-7)


def test_an_equation_of_contacts_that_know_time_has_a_velocity() -> None:
    theory = asp.MasterEquation(GROWING, velocity=1.0)
    assert theory.velocity == 1.0
    # The tolerance by default, above the digits printed.
    assert theory.steady_state().kinetic_friction == pytest.approx(0.5122109494, abs=1e-9)
    with pytest.raises(
        ValueError,
        match=r"velocity: expected a velocity above 0, since ageing makes contacts time-dependent",
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
    # cohorts of less than 1e-4 tolerances are dropped, and count as detached until the next step
    assert trace["free"] == pytest.approx(0.0, abs=1e-8)
    ensemble = asp.Ensemble(GROWING, size=20_000).follow(steps)
    # 6 standard errors, by chance once in a million; and two contacts: nothing scatters before a first break
    assert np.all(np.abs(ensemble["force"] - trace["force"]) < 6 * ensemble["force_error"] + 1e-4)


def test_both_solvers_follow_steps_of_the_normal_load() -> None:
    steps = [
        asp.Step(1.0, distance=1.2, points=5),
        asp.Step(1.0, distance=2.0, points=9, relative_normal_load=1.5),
        asp.Step(hold=10.0, points=3, relative_normal_load=0.5),
    ]
    trace = asp.Transport(GROWING).follow(steps)
    # two points at each step of the load
    assert trace["time"].shape == (5 + 8 + 2 + 2,)
    loads = trace["relative_normal_load"]
    assert loads.tolist() == [1.0] * 5 + [1.5] * 9 + [0.5] * 3
    # contacts form unstretched, and are lost at random
    assert trace["force"][4] == trace["force"][5]
    assert trace["force"][14] == pytest.approx(trace["force"][13] / 3.0, rel=1e-12)
    ensemble = asp.Ensemble(GROWING, size=20_000).follow(steps)
    np.testing.assert_array_equal(ensemble["relative_normal_load"], loads)
    # as above
    assert np.all(np.abs(ensemble["force"] - trace["force"]) < 6 * ensemble["force_error"] + 1e-4)
    constant = asp.Transport(GROWING).follow([asp.Step(1.0, distance=1.0, relative_normal_load=1.0)])
    assert "relative_normal_load" not in constant


def test_steps_of_the_normal_load_are_refused_where_they_are_not_followed() -> None:
    steps = [asp.Step(0.1, distance=1.0), asp.Step(0.1, distance=1.0, relative_normal_load=2.0)]
    block = asp.Block(asp.Transport(GROWING), 1.0, asp.Damped(1.0))
    with pytest.raises(ValueError, match=r"relative_normal_load: expected 1, or none"):
        block.follow(steps)
    shared = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=asp.MeanField(asp.Gaussian(1.0, 0.05), 0.0025))
    with pytest.raises(ValueError, match="mean_field"):
        asp.Transport(shared).follow(steps)


def test_a_pull_at_a_velocity_is_a_way_at_one_velocity() -> None:
    pull = asp.MasterEquation(THERMAL, velocity=0.01).pull(3.0, 31)
    trace = asp.Transport(THERMAL).follow([asp.Step(0.01, distance=3.0, points=31)])
    # the tolerance of the transport, 1e-7, with room for its being an estimate
    assert trace["force"] == pytest.approx(pull.force, abs=1e-6)


def test_a_transport_starts_in_steady_sliding() -> None:
    steady = asp.Transport(GROWING, start="steady", velocity=1.0)
    assert (steady.start, steady.velocity) == ("steady", 1.0)
    trace = steady.follow([asp.Step(1.0, distance=2.0, points=11)])
    # the reference of the theory, and the tolerance of the transport
    assert trace["force"] == pytest.approx(0.5122109494, abs=1e-6)
    slider = asp.Block(steady, 2.0, asp.Damped(0.1)).drive(1.0, 6, velocity=1.0)
    # in balance with the drag 0.1 · 1, to the tolerance of a block in time
    assert slider.spring_force == pytest.approx(0.6122109494, abs=1e-3)
    with pytest.raises(ValueError, match="velocity: expected a velocity beside start='steady'"):
        asp.Transport(GROWING, start="steady")
    with pytest.raises(ValueError, match="velocity: expected no velocity but that of start='steady'"):
        asp.Transport(GROWING, velocity=1.0)
    with pytest.raises(ValueError, match="start: expected conditional or relaxed for time-dependent"):
        asp.MasterEquation(GROWING, velocity=1.0, start="steady")
    athermal = asp.MasterEquation(asp.Contacts(THRESHOLDS), start="steady")
    # F_k of thresholds with σ = 0.1, to the aim of the master equation
    assert athermal.pull(3.0, 31).force == pytest.approx(0.505, abs=1e-9)


def test_free_times_of_a_distribution() -> None:
    contacts = asp.Contacts(THRESHOLDS, delay=asp.Exponential(0.5), free_friction=0.2, free_viscosity=0.3)
    assert contacts.delay == asp.Exponential(0.5)
    assert (contacts.free_friction, contacts.free_viscosity) == (0.2, 0.3)
    assert contacts == pickle.loads(pickle.dumps(contacts)) == copy.deepcopy(contacts)
    assert eval(repr(contacts), vars(asp)) == contacts
    assert contacts.replace(delay=0.5).delay == 0.5
    # Kinetic friction depends on the mean free time only.
    velocity, law = 2.0, contacts.thresholds
    assert law is not None
    free = velocity * 0.5
    carried = 0.5 * law.moment(2) + (0.2 + 0.3 * velocity) * free
    friction = asp.MasterEquation(contacts, velocity=velocity).steady_state().kinetic_friction
    assert friction == pytest.approx(carried / (law.mean() + free), rel=1e-12)
    trace = asp.Transport(contacts).follow([asp.Step(velocity, distance=40.0)])
    # The default tolerance of 1e-6, and what of the transient is left.
    assert trace.force[-1] == pytest.approx(friction, abs=1e-5)
    with pytest.raises(ValueError, match="delay: expected a density of times without a pole"):
        asp.MasterEquation(asp.Contacts(THRESHOLDS, delay=asp.Gamma(1.0, 2.0)), velocity=1.0)


def test_free_contacts_carry_nothing() -> None:
    contacts = asp.Contacts(THRESHOLDS, delay=0.5)
    assert contacts.delay == 0.5
    steady = asp.velocity_curve(contacts, 2.0)
    # F_k ∫xS/(C + vτ) with C = 1, ∫xS = 0.505
    assert steady == pytest.approx(0.505 / 2.0, abs=1e-9)


def test_rules_are_described() -> None:
    for rule in [
        asp.Temperature(0.05, 2.0, barrier="bell"),
        asp.Temperature(0.05, 2.0, hazard="additive"),
        asp.Smoluchowski(asp.Gaussian(1.0, 0.05), 0.0025),
        asp.FrozenRank(asp.Gaussian(1.0, 0.05), 1.0),
        asp.Logarithmic(0.02, 1.0),
        asp.MeanField(asp.Gaussian(1.0, 0.05), 0.0025),
        asp.Step(1.0, duration=2.0, velocity_to=3.0, pieces=5),
        asp.Step(hold=2.0, relative_normal_load=1.5),
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
        (
            lambda: asp.Step(hold=1.0, relative_normal_load=0.0),
            r"step\.relative_normal_load: expected a number above 0, got 0",
        ),
        (
            lambda: asp.Transport(THERMAL).follow([asp.Step(hold=1.0, relative_normal_load=2.0)]),
            r"steps\.0\.relative_normal_load: expected 1, or none, in the first step",
        ),
        (lambda: asp.Temperature(1.0, 1.0, barrier="high"), "barrier"),  # type: ignore[arg-type]
        (lambda: asp.Temperature(1.0, 1.0, hazard="none"), "hazard"),  # type: ignore[arg-type]
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
    # A protocol has that of each step, a hold has none.
    steady, held = np.asarray(result.kinetic_friction)
    assert steady == pytest.approx(asp.velocity_curve(GROWING, 1.0))
    assert np.isnan(held)
    assert [step["velocity"] for step in result.summary["steps"]] == [1.0, 0.0]


AGEING = asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=asp.Logarithmic(0.05, 1.0))


def test_a_block_is_moved_in_time() -> None:
    block = asp.Block(asp.Transport(AGEING), 0.3, asp.Damped(0.1))
    assert (block.model.contacts, block.model.start) == (AGEING, "conditional")
    run = block.drive(5.0, 51, velocity=0.01)
    same = block.follow([asp.Step(0.01, distance=5.0, points=51)])
    assert np.array_equal(run["force"], same["force"])
    assert len(run.events) == 2
    # Ten units of the last digit, which follows the step-size control.
    assert run.events[0].time == pytest.approx(409.013, abs=0.01)
    assert set(run.events[0]._asdict()) == set(asp.Event._fields)
    # a step is right to 1e-4, times forces below 1, over a way of 5
    assert abs(run.energy.imbalance) < 5e-4 < run.energy.breaks
    assert run.events["dissipated_breaks"].sum() < run.energy.breaks
    assert run.energy.strengthening == run.energy.kinetic == 0.0
    assert run["time"][0] == 0.0
    # of dropped cohorts, as above
    assert run["free"] == pytest.approx(0.0, abs=1e-8)
    # drives at slips scatter by some N^(-2/3), 0.016
    sample = asp.Block(asp.Ensemble(AGEING, size=500), 0.3, asp.Damped(0.1)).drive(4.8, velocity=0.01)
    assert sample.events[0].drive == pytest.approx(run.events[0].drive, abs=4 * 0.016)


def test_ageing_that_stiffens_is_in_the_books() -> None:
    stiffening = AGEING.replace(stiffness=None, stiffness_per_threshold=1.0)
    block = asp.Block(asp.Transport(stiffening, tolerance=1e-4), 0.3, asp.Inertial(1.0, 0.1))
    run = block.drive(6.0, 51, velocity=0.01)
    assert run.events[0].strengthening is not None
    assert run.energy.strengthening > 0.01
    # as above, over a way of 6
    assert abs(run.energy.imbalance) < 6e-4


def test_what_does_not_go_with_time_is_refused() -> None:
    transport = asp.Transport(AGEING)
    damped = asp.Damped(0.1)
    with pytest.raises(
        ValueError, match=r"block\.model: expected a Transport or an Ensemble where time passes"
    ):
        asp.Block(asp.MasterEquation(AGEING, velocity=1.0), 1.0, damped).drive(velocity=1.0)
    with pytest.raises(
        ValueError, match=r"block\.model: expected a MasterEquation or an Ensemble where no time"
    ):
        asp.Block(transport, 1.0, damped).drive()
    with pytest.raises(ValueError, match=r"block\.slip: expected damped or inertial"):
        asp.Block(transport, 1.0, "overdamped").drive(velocity=1.0)
    with pytest.raises(ValueError, match=r"block\.stiffness: expected a finite stiffness in time"):
        asp.Block(transport, None, damped).drive(velocity=1.0)
    with pytest.raises(ValueError, match=r"drive\.turning_points\.1: expected a position above 3"):
        asp.Block(transport, 1.0, damped).drive(turning_points=[3.0, 1.0], velocity=1.0)
    with pytest.raises(ValueError, match=r"drive\.force_to: expected no imposed force"):
        asp.Block(transport, None, damped).drive(force_to=1.0, velocity=1.0)
    with pytest.raises(ValueError, match="steps"):
        asp.Block(transport, 1.0, damped).follow([])


def test_the_spring_of_a_machine_is_in_balance_without_damping() -> None:
    sliding = asp.Transport(AGEING, start="steady", velocity=0.1)
    steps = [asp.Step(0.1, distance=0.1, points=2), asp.Step(1.0, distance=2.0, points=21)]
    run = asp.Block(sliding, 2.0).follow(steps)
    # The balance of a stage and the merging of cohorts after it, each a few hundredths of the tolerance 1e-4.
    assert abs(run["spring_force"] - run["force"]).max() < 5e-6
    assert abs(2.0 * (run["drive"] - run["position"]) - run["force"]).max() < 5e-6
    # The velocity of the load point, which the slider reaches.
    assert run["velocity"][-1] == pytest.approx(1.0, abs=0.2)


def test_steady_sliding_needs_damping_where_contacts_age() -> None:
    transport = asp.Transport(asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=asp.Logarithmic(0.02, 1.0)))
    heavy = asp.Block(transport, 0.25, asp.Inertial(mass=1e3)).stability(1e-3)
    assert heavy.critical_stiffness == heavy.frequency == np.inf
    assert heavy.growth_rate > 0.0
    assert heavy.growth_frequency > 0.0
    damped = asp.Block(transport, 0.25, asp.Inertial(mass=1e3, damping=5.0)).stability(1e-3)
    assert 0.0 < damped.critical_stiffness < 0.25
    assert damped.growth_rate == damped.growth_frequency == 0.0
    with pytest.raises(ValueError, match="velocity"):
        asp.Block(transport, 0.25, asp.Damped(1.0)).stability(0.0)
    with pytest.raises(ValueError, match=r"block\.slip"):
        asp.Block(transport, 0.25).stability(1e-3)
    with pytest.raises(ValueError, match=r"block\.model"):
        asp.Block(asp.MasterEquation(asp.Contacts(THRESHOLDS)), 0.25, asp.Damped(1.0)).stability(1e-3)


def test_the_closure_of_steady_sliding_knows_no_first_loading() -> None:
    closure = asp.Contacts(asp.Gaussian(0.5, 0.1), ageing=asp.MeanField(asp.Gaussian(1.0, 0.05), 0.0025))
    theory = asp.MasterEquation(closure, velocity=0.1)
    # The tolerance of the closure by default.
    assert theory.steady_state().kinetic_friction == pytest.approx(0.4831162958, abs=4e-7)
    assert np.isnan(theory.relaxation().length)
    with pytest.raises(ValueError, match=r"^ageing\.mean_field"):
        theory.pull(5.0)


def test_contacts_that_share_thresholds_slide_on_with_the_friction_of_the_closure() -> None:
    ageing = asp.MeanField(asp.Gaussian(1.0, 0.2), 0.04)
    contacts = asp.Contacts(asp.Gaussian(0.6, 0.15), ageing=ageing)
    friction = asp.velocity_curve(contacts, 1.0)
    motion = asp.Transport(contacts, velocity=1.0, start="steady").follow([asp.Step(1.0, distance=1.0)])
    # The default tolerance.
    assert motion["force"][-1] == pytest.approx(friction, abs=1e-6)
    result = asp.run({"contacts": contacts, "protocol": [{"velocity": 1.0, "distance": 1.0}]})
    assert np.asarray(result.kinetic_friction)[0] == pytest.approx(friction)


def test_a_protocol_has_the_kinetic_friction_of_each_step() -> None:
    steps = [{"velocity": 1.0, "distance": 2.0}, {"hold": 1.0}, {"velocity": 0.1, "distance": 1.0}]
    result = asp.run({"contacts": GROWING, "protocol": steps})
    fast, held, slow = np.asarray(result.kinetic_friction)
    assert (fast, slow) == pytest.approx([asp.velocity_curve(GROWING, 1.0), asp.velocity_curve(GROWING, 0.1)])
    assert np.isnan(held)

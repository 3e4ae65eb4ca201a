"""Wrong input is refused with ValueError or TypeError: never a panic, never a wrong number."""

import math
import re
from collections.abc import Callable
from typing import Any

import asperity as asp
import numpy as np
import pytest
from families import PARAMETRIC, member
from hypothesis import HealthCheck, given, settings, strategies as st

REFUSED = (ValueError, TypeError)
# Machines differ in speed, and examples should not from run to run.
settings.register_profile(
    "asperity", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("asperity")

anything = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**70), 2**70),
    st.floats(),
    st.complex_numbers(),
    st.text(max_size=5),
    st.binary(max_size=3),
    st.lists(st.floats() | st.text(max_size=2), max_size=4),
    st.lists(st.lists(st.floats(), max_size=3), max_size=3),
    st.dictionaries(st.text(max_size=3), st.floats(), max_size=2),
    st.sampled_from([np.array(["a"]), np.zeros((2, 2)), np.array([1j]), np.array([None]), object(), len]),
)
numbers = st.floats(allow_nan=True, allow_infinity=True)
sizes = st.floats(1e-6, 1e6)

CONTACTS = asp.Contacts(asp.Gaussian(1.0, 0.1))
THEORY = asp.MasterEquation(CONTACTS)
PULL = THEORY.pull(2.0, 11)
BLOCK = asp.Block(THEORY, 1.0, "overdamped")
RIGID = asp.Block(THEORY, None)
LAW = asp.Gamma(1.0, 0.3)
RULES: list[Any] = ["reset", "overdamped", "arrest", None]
FUNCTIONS = ["pdf", "cdf", "sf", "logsf", "hazard", "ppf", "isf"]


@given(kind=st.sampled_from(PARAMETRIC), first=anything, second=anything)
def test_laws_of_anything(kind: Any, first: Any, second: Any) -> None:
    try:
        law = member(kind, first, second)
    except REFUSED:
        return
    assert all(np.isfinite(value) for value in law.parameters.values())


@given(kind=st.sampled_from(PARAMETRIC), first=sizes, second=sizes, x=numbers, q=st.floats(0.0, 1.0))
def test_functions_of_laws_are_those_of_some_law(
    kind: Any, first: float, second: float, x: float, q: float
) -> None:
    try:
        law = member(kind, first, second)
    except REFUSED:
        return
    if np.isnan(x):
        with pytest.raises(ValueError, match="x: expected a number, got NaN"):
            law.pdf(x)
        return
    below, above = law.cdf(x), law.sf(x)
    assert 0.0 <= below <= 1.0
    assert 0.0 <= above <= 1.0
    # Rounding of S near its steepest, where x itself is a rounded number.
    assert below + above == pytest.approx(1.0, abs=1e-9)
    assert law.pdf(x) >= 0.0
    assert law.logsf(x) <= 0.0
    assert law.hazard(x) >= 0.0
    low, high = law.support()
    assert 0.0 <= low <= law.ppf(q) <= high
    assert low <= law.isf(q) <= high
    assert low <= law.mean() <= high


@given(name=st.sampled_from(FUNCTIONS), x=anything)
def test_functions_of_anything(name: str, x: Any) -> None:
    try:
        values = getattr(LAW, name)(x)
    except REFUSED:
        return
    assert np.shape(values) == np.shape(x)
    assert not np.any(np.isnan(values))


@given(q=numbers)
def test_quantiles_are_of_probabilities(q: float) -> None:
    if 0.0 <= q <= 1.0:
        assert LAW.ppf(q) >= 0.0
    else:
        with pytest.raises(ValueError, match=r"q: expected a probability from 0 to 1, got "):
            LAW.ppf(q)


@given(values=st.lists(numbers, max_size=6), others=st.lists(numbers, max_size=6))
def test_tables_of_anything(values: list[float], others: list[float]) -> None:
    columns = ({"samples": values}, {"stretch": sorted(values), "density": others})
    tables: list[dict[str, Any]] = [*columns, columns[0] | columns[1]]
    for given_columns in tables:
        try:
            law = asp.Tabulated(**given_columns)
        except REFUSED:
            continue
        assert law.cdf(law.support()[1]) == 1.0
        assert 0.0 <= law.mean() < np.inf


# Every argument of everything public, each called with only that argument wrong.
CALLS: dict[str, Callable[[Any], object]] = {
    "Mixture": lambda x: asp.Mixture(x),
    "Mixture.weight": lambda x: asp.Mixture([(x, LAW)]),
    "Mixture.law": lambda x: asp.Mixture([(1.0, x)]),
    "Renormalised.law": lambda x: asp.Renormalised(x, 0.1),
    "Renormalised.coupling": lambda x: asp.Renormalised(LAW, x),
    "critical_coupling": lambda x: asp.critical_coupling(x),
    "Tabulated.samples": lambda x: asp.Tabulated(samples=x),
    "Tabulated.stretch": lambda x: asp.Tabulated(stretch=x, density=[1.0, 1.0]),
    "Tabulated.density": lambda x: asp.Tabulated(stretch=[0.0, 1.0], density=x),
    "Series.boundaries": lambda x: asp.Series(x, [[1.0]]),
    "Series.coefficients": lambda x: asp.Series([0.0, 1.0], x),
    "Series.cut": lambda x: asp.Series([0.0, 1.0], [[1.0]], cut=x),
    "Areas.law": lambda x: asp.Areas(x, 1.0, 1.0),
    "Areas.modulus": lambda x: asp.Areas(LAW, x, 1.0),
    "Areas.strength": lambda x: asp.Areas(LAW, 1.0, x),
    "Contacts.thresholds": lambda x: asp.Contacts(x),
    "Contacts.reforming": lambda x: asp.Contacts(LAW, x),
    "Contacts.areas": lambda x: asp.Contacts(areas=x),
    "Contacts.count": lambda x: asp.Contacts(LAW, count=x),
    "Contacts.stiffness": lambda x: asp.Contacts(LAW, stiffness=x),
    "Contacts.stiffness_per_threshold": lambda x: asp.Contacts(LAW, stiffness_per_threshold=x),
    "Contacts.stiffness_of_threshold": lambda x: asp.Contacts(LAW, stiffness_of_threshold=(x, [1.0, 2.0])),
    "Contacts.normal_load": lambda x: asp.Contacts(LAW, normal_load=x),
    "Contacts.background_force": lambda x: asp.Contacts(LAW, background_force=x),
    "Contacts.background_coefficient": lambda x: asp.Contacts(LAW, normal_load=1.0, background_coefficient=x),
    "MasterEquation.contacts": lambda x: asp.MasterEquation(x),
    "MasterEquation.initial": lambda x: asp.MasterEquation(CONTACTS, x),
    "MasterEquation.start": lambda x: asp.MasterEquation(CONTACTS, start=x),
    "MasterEquation.tolerance": lambda x: asp.MasterEquation(CONTACTS, tolerance=x),
    "pull.progress": lambda x: THEORY.pull(1.0, 3, progress=None if x is True else x),
    "Ensemble.contacts": lambda x: asp.Ensemble(x),
    "Ensemble.initial": lambda x: asp.Ensemble(CONTACTS, x),
    "Ensemble.size": lambda x: asp.Ensemble(CONTACTS, size=x),
    "Ensemble.seed": lambda x: asp.Ensemble(CONTACTS, seed=x),
    "Ensemble.disorder": lambda x: asp.Ensemble(CONTACTS, disorder=x),
    "Ensemble.start": lambda x: asp.Ensemble(CONTACTS, start=x),
    "Ensemble.pull.snapshots": lambda x: asp.Ensemble(CONTACTS, size=2).pull(2.0, 3, snapshots=x),
    "Ensemble.pull.edges": lambda x: asp.Ensemble(CONTACTS, size=2).pull(2.0, 3, snapshots=[1.0], edges=x),
    "Damped.damping": lambda x: asp.Damped(x),
    "Inertial.mass": lambda x: asp.Inertial(x),
    "Inertial.damping": lambda x: asp.Inertial(1.0, x),
    "Block.model": lambda x: asp.Block(x, 1.0),
    "Block.stiffness": lambda x: asp.Block(THEORY, x, "overdamped").drive(3.0, 11),
    "Block.slip": lambda x: asp.Block(THEORY, 1.0, x),
    "Block.slip_fraction": lambda x: asp.Block(THEORY, 1.0, slip_fraction=x),
    "Block.drive.force_to": lambda x: RIGID.drive(force_to=x),
    "Block.drive.progress": lambda x: BLOCK.drive(1.0, 3, progress=None if x is True else x),
    "Block.potential": lambda x: BLOCK.potential(x, 1.0, 3),
    "force_at": lambda x: PULL.force_at(x),
    "slope_at": lambda x: PULL.slope_at(x),
    "breaking_rate_at": lambda x: PULL.breaking_rate_at(x),
    "force_std.size": lambda x: PULL.force_std(x),
    "force_std.at": lambda x: PULL.force_std(10, x),
    "stretch_density.at": lambda x: PULL.stretch_density(x, [0.5]),
    "stretch_density.stretches": lambda x: PULL.stretch_density(1.0, x),
    "SteadyState.force_std": lambda x: THEORY.steady_state().force_std(x),
    "SteadyState.stretch_density": lambda x: THEORY.steady_state().stretch_density(x),
    "Relaxation.force": lambda x: THEORY.relaxation().force(x),
    "rvs.seed": lambda x: LAW.rvs(2, seed=x),
    "moment": lambda x: LAW.moment(x),
    "law": lambda x: asp.law(x),
    "run": lambda x: asp.run(x),
    "exact.Gaussian.mean": lambda x: asp.exact.Gaussian(x, 0.1).force(2.0),
    "exact.Gaussian.std": lambda x: asp.exact.Gaussian(1.0, x),
    "exact.Gaussian.initial_mean": lambda x: asp.exact.Gaussian(1.0, 0.1, x, 0.1),
    "exact.Gaussian.initial_std": lambda x: asp.exact.Gaussian(1.0, 0.1, 0.1, x),
    "exact.Gaussian.relaxation_root": lambda x: asp.exact.Gaussian(1.0, 0.1).relaxation_root(x),
    "exact.Gaussian.variance": lambda x: asp.exact.Gaussian(1.0, 0.1).variance(x),
    "exact.Rectangular.min": lambda x: asp.exact.Rectangular(x, 1.0),
    "exact.Rectangular.max": lambda x: asp.exact.Rectangular(0.5, x),
    "exact.Rectangular.force": lambda x: asp.exact.Rectangular(0.5, 1.0).force(x),
    "exact.Rectangular.stick_slip_period": lambda x: asp.exact.Rectangular(0.7, 1.0).stick_slip_period(x),
    "exact.Gamma.mean": lambda x: asp.exact.Gamma(x, 0.1),
    "exact.Gamma.std": lambda x: asp.exact.Gamma(1.0, x),
    "exact.Erlang.shape": lambda x: asp.exact.Erlang(x, 1.0),
    "exact.Erlang.rate": lambda x: asp.exact.Erlang(2, x),
    "exact.Identical": lambda x: asp.exact.Identical(x),
    "exact.Quenched": lambda x: asp.exact.Quenched(x),
    "exact.Quenched.force": lambda x: asp.exact.Quenched(LAW).force(x),
    "exact.kinetic_friction": lambda x: asp.exact.kinetic_friction(x),
    "exact.kinetic_friction.reforming": lambda x: asp.exact.kinetic_friction(LAW, x),
    "exact.steady_variance": lambda x: asp.exact.steady_variance(x),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS.keys())
@given(x=anything)
@settings(max_examples=60)
def test_every_argument_of_anything(call: Callable[[Any], object], x: Any) -> None:
    try:
        call(x)
    except (*REFUSED, FileNotFoundError, MemoryError):
        # No file has a name by chance, and no machine holds some sizes.
        pass


def quick(distance: Any, points: Any) -> bool:
    """Whether it makes no sense or takes no time."""
    few = not isinstance(points, int) or not 1e4 < points < 1e7
    return few and (not isinstance(distance, (int, float)) or not 1e3 < abs(distance) < np.inf)


@given(distance=anything, points=anything)
def test_pulls_of_anything(distance: Any, points: Any) -> None:
    if not quick(distance, points):
        return
    for pull in (THEORY.pull, BLOCK.drive, RIGID.drive):
        try:
            pulled = pull(distance, points)
        except (*REFUSED, MemoryError):
            continue
        assert not any(np.any(np.isnan(values)) for values in pulled.values())


@given(distance=anything, points=anything)
def test_equilibria_of_anything(distance: Any, points: Any) -> None:
    if not quick(distance, points):
        return
    try:
        equilibria, potential = (
            BLOCK.equilibrium(distance, points),
            BLOCK.potential([1.0, 2.0], distance, points),
        )
    except (*REFUSED, MemoryError):
        return
    assert not np.any(np.isnan(equilibria.drive))
    assert potential.energy.shape == (2, equilibria.position.size)


@given(turning_points=anything | st.lists(st.floats(-10.0, 10.0) | numbers, max_size=4))
def test_turning_points_of_anything(turning_points: Any) -> None:
    if isinstance(turning_points, list) and not all(quick(point, 11) for point in turning_points):
        return
    try:
        run = BLOCK.drive(points=11, turning_points=turning_points)
    except (*REFUSED, MemoryError):
        return
    assert run.drive[-1] == (20.0 if turning_points is None else turning_points[-1])
    assert not any(np.any(np.isnan(values)) for values in run.values())


@given(stiffness=sizes, mass=sizes, damping=st.floats(0.0, 1e3), slip=st.sampled_from(RULES))
def test_sliders_of_any_kind(stiffness: float, mass: float, damping: float, slip: Any) -> None:
    rule = slip or asp.Inertial(mass, damping)
    if rule == asp.Inertial(mass, damping) and damping > 1e3 * math.sqrt(mass * stiffness):
        with pytest.raises(ValueError, match="damping: expected a damping up to"):
            asp.Block(THEORY, stiffness, rule)
        return
    run = asp.Block(THEORY, stiffness, rule).drive(4.0, 11)
    assert not any(np.any(np.isnan(values)) for values in run.values())
    assert np.all(run.events["drop"] >= 0.0)
    # The energy balance of an inertial slip closes to 1e-7 of the energies that pass through them.
    assert abs(run.energy.imbalance) <= 1e-7 * max(1.0, run.energy.work)


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (lambda: asp.Gaussian(1.0, -0.05), ValueError, r"gaussian\.std: expected a finite .* got -0\.05"),
        (lambda: asp.Gaussian(float("nan"), 1.0), ValueError, r"gaussian\.mean: .* got NaN"),
        (lambda: asp.Gaussian("1", 1.0), TypeError, "mean: expected a number, got str"),  # type: ignore[arg-type]
        (lambda: asp.Mixture([(0.5, LAW)]), ValueError, r"mixture.*sum"),
        (lambda: asp.Renormalised(LAW, 0.9), ValueError, r"renormalised\.coupling: .* from 0 to below 0\.7"),
        (lambda: asp.Renormalised(asp.Point(1.0), 0.1), ValueError, r"renormalised\.law: .* identical"),
        (lambda: LAW.pdf([1.0, np.nan]), ValueError, r"x\.1: expected a number, got NaN"),
        (lambda: LAW.pdf(["a"]), TypeError, "x: expected numbers, got list of dtype <U1"),
        (lambda: LAW.pdf(1j), TypeError, "x: expected numbers, got complex of dtype complex128"),
        (lambda: LAW.ppf(1.5), ValueError, r"q: expected a probability from 0 to 1, got 1\.5"),
        (lambda: LAW.rvs(2, seed=-1), ValueError, r"seed: expected a whole number from 0 to 2\^63 - 1"),
        (lambda: LAW.rvs(2, seed=0.5), TypeError, "seed: expected a whole number"),  # type: ignore[call-overload]
        (lambda: LAW.rvs(-2, seed=1), ValueError, "size: expected"),
        (lambda: LAW.rvs(2**60, seed=1), MemoryError, "size: more numbers than fit"),
        (lambda: LAW.moment(-1), ValueError, "order: expected a whole number"),
        (lambda: asp.Temperature(0.0, 1.0), ValueError, "energy: expected a finite number above 0, got 0"),
        (lambda: asp.Temperature(1.0, np.inf), ValueError, "attempt_rate: expected .* above 0, got inf"),
        (lambda: asp.Smoluchowski(LAW, 0.0), ValueError, "diffusion: expected .* above 0, got 0"),
        (lambda: asp.MeanField(LAW, -1.0), ValueError, "diffusion: expected .* above 0, got -1"),
        (lambda: asp.FrozenRank(LAW, np.nan), ValueError, "time: expected .* above 0, got NaN"),
        (lambda: asp.Logarithmic(-0.1, 1.0), ValueError, r"growth: expected .* 0 or above, got -0\.1"),
        (lambda: asp.Logarithmic(0.1, 0.0), ValueError, "time: expected .* above 0, got 0"),
        (
            lambda: PULL.stretch_density(1.0, [-1.0]),
            ValueError,
            r"stretches\.0: expected a stretch of 0 or above, got -1",
        ),
        (lambda: asp.Contacts(), ValueError, r"contacts\.thresholds: expected a distribution"),
        (lambda: asp.Contacts(LAW, count=0), ValueError, r"contacts\.count: expected .* above 0, got 0"),
        (
            lambda: asp.MasterEquation(asp.Contacts(asp.Rectangular(0.5, 1.0)), asp.Point(2.0)),
            ValueError,
            "initial: expected stretches below the highest threshold 1",
        ),
        (lambda: asp.MasterEquation(CONTACTS, start="rest"), ValueError, "conditional, relaxed and steady"),  # type: ignore[arg-type]
        (lambda: THEORY.pull(-1.0), ValueError, r"pull\.distance: expected a number above 0, got -1"),
        (lambda: THEORY.pull(1.0, -1), ValueError, "points: expected a whole number, 0 or above, .* got -1"),
        (lambda: THEORY.pull(1.0, 1), ValueError, r"pull\.points: expected 2 points or more"),
        (lambda: THEORY.pull(1.0, 2**50), ValueError, r"pull\.points: expected at most"),
        (lambda: THEORY.pull(1.0, progress=3), TypeError, "progress: expected a function"),  # type: ignore[arg-type]
        (lambda: PULL(3.0), ValueError, "position: expected a position from 0 to 2, got 3"),
        (lambda: PULL.stretch_density([[1.0]]), ValueError, "at: expected a list of numbers, got an array"),
        (lambda: asp.Ensemble(CONTACTS, size=0), ValueError, r"ensemble\.size: expected 1 contact or more"),
        (lambda: asp.Block(THEORY, -1.0), ValueError, r"block\.stiffness: expected .* above 0, got -1"),
        (lambda: asp.Block(THEORY, np.nan), ValueError, r"block\.stiffness: expected a finite .* got NaN"),
        (lambda: asp.Block(THEORY, 1.0, "sticky"), ValueError, "slip: expected one of reset, .* \"sticky\""),  # type: ignore[arg-type]
        (lambda: asp.Block(THEORY, 1.0, 3), TypeError, "slip: expected a word, asperity.Damped .*, got int"),  # type: ignore[arg-type]
        (lambda: asp.Block(CONTACTS, 1.0), TypeError, "model: expected Model, got Contacts"),  # type: ignore[arg-type]
        (lambda: asp.Block(THEORY, 1.0, slip_fraction=0), ValueError, r"slip_fraction: expected .* got 0"),
        (lambda: asp.Inertial(0.0), ValueError, r"slip\.inertial\.mass: expected .* above 0, got 0"),
        (
            lambda: asp.Block(THEORY, 1.0, asp.Inertial(1.0, 1e6)),
            ValueError,
            r"block\.slip\.inertial\.damping: expected a damping up to 1000 .* got 1000000",
        ),
        (lambda: BLOCK.drive(-1.0), ValueError, r"drive\.distance: expected a number above 0, got -1"),
        (lambda: BLOCK.drive(points=1), ValueError, r"drive\.points: expected 2 points or more"),
        (lambda: BLOCK.drive(turning_points=[3.0, 4.0]), ValueError, r"drive\.turning_points\.1: .* below 3"),
        (lambda: BLOCK.drive(turning_points=[]), ValueError, r"drive\.turning_points: expected at least one"),
        (lambda: BLOCK.drive(turning_points=3.0), TypeError, "turning_points: expected a list of numbers"),
        (lambda: BLOCK.drive(3.0, turning_points=[3.0]), ValueError, "only one of distance, turning_points"),
        (lambda: BLOCK.drive(force_to=1.0), ValueError, r"block: expected no block .* of stiffness 1"),
        (lambda: RIGID.drive(force_to=-1.0), ValueError, r"drive\.force_to: expected a number above 0"),
        (lambda: RIGID.potential(1.0), ValueError, r"block\.stiffness: expected a finite .* got inf"),
        (lambda: BLOCK.potential(np.nan), ValueError, "drive: expected a drive, got NaN"),
        (lambda: BLOCK.equilibrium(0.0), ValueError, r"equilibrium\.distance: expected .* above 0, got 0"),
        (lambda: asp.exact.Rectangular(1.0, 0.5), ValueError, r"max: expected .* min = 1, got 0\.5"),
    ],
)  # fmt: skip
def test_errors_say_what_was_expected_and_what_came(
    call: Callable[[], object], error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text):
        call()


class Endless:
    """Says that it is a list of itself."""

    def tolist(self) -> "Endless":
        return self


class Deeper:
    """Says that it is a list of another one."""

    def tolist(self) -> "list[Deeper]":
        return [Deeper()]


def held_by_itself() -> dict[str, Any]:
    table: dict[str, Any] = {}
    table["contacts"] = table
    return table


def deep(levels: int) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for _ in range(levels):
        table = {"contacts": table}
    return table


@pytest.mark.parametrize(
    "scenario", [held_by_itself(), deep(100_000), {"contacts": Endless()}, {"contacts": Deeper()}]
)
def test_what_never_ends_is_refused(scenario: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="contacts: expected at most 64 tables and lists within each other"):
        asp.run(scenario)
    with pytest.raises(ValueError, match="contacts: expected at most 64 tables and lists within each other"):
        asp.run("scenarios/fig2.toml", scenario)


def test_lists_that_never_end_are_refused() -> None:
    endless: list[Any] = []
    endless.extend([endless, endless])
    with pytest.raises(ValueError, match="x: expected at most 64 tables and lists within each other"):
        LAW.pdf(endless)


MASKED = np.ma.masked_array([1.0, 1.1, 1e20], mask=[False, False, True])
WITHOUT = MASKED.compressed()


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda: LAW.pdf(MASKED), "x"),
        (lambda: LAW.pdf(np.ma.masked_equal([1, 2], 2)), "x"),
        (lambda: LAW.pdf([MASKED, MASKED]), r"x\.0"),
        (lambda: asp.Tabulated(samples=MASKED), "samples"),
        (lambda: asp.law(MASKED), "samples"),
        (lambda: THEORY.pull(2.0).force_at(MASKED), "position"),
        (lambda: asp.run({"contacts": {"thresholds": {"tabulated": {"samples": MASKED}}}}), "samples"),
    ],
)  # fmt: skip
def test_masked_values_are_refused(call: Callable[[], object], key: str) -> None:
    way = r"\(compressed\(\) leaves out those that are\)"
    expected = f"expected numbers none of which is masked {way}, got 1 masked of"
    with pytest.raises(ValueError, match=f"{key}: {expected}"):
        call()


def test_masks_that_hide_nothing_are_none() -> None:
    assert np.array_equal(LAW.pdf(np.ma.masked_array(WITHOUT)), LAW.pdf(WITHOUT))
    assert asp.Tabulated(samples=np.ma.masked_array(WITHOUT)) == asp.Tabulated(samples=WITHOUT)


@pytest.mark.parametrize(
    ("call", "wrong", "message"),
    [
        (lambda x: asp.Gaussian(x, 0.1), "1", "mean: expected a number, got str"),
        (lambda x: asp.Weibull(2.0, x), [1.0], "scale: expected a number, got list"),
        (lambda x: asp.Renormalised(LAW, x), None, "coupling: expected a number, got NoneType"),
        (lambda x: asp.Areas(LAW, 1.0, x), "x", "strength: expected a number, got str"),
        (lambda x: asp.Contacts(LAW, stiffness=x), "x", "stiffness: expected a number, got str"),
        (lambda x: asp.Temperature(x, 1.0), "x", "energy: expected a number, got str"),
        (lambda x: asp.Logarithmic(growth=x, time=1.0), "x", "growth: expected a number, got str"),
        (
            lambda x: asp.Contacts(x),
            "x",
            "thresholds: expected a distribution of asperity, a frozen distribution of scipy.stats, "
            "or samples, got str",
        ),
        (
            lambda x: asp.Mixture(x),
            1.0,
            "components: expected a list of pairs (weight, distribution), got float",
        ),
        (lambda x: asp.Block(x, 1.0), LAW, "model: expected Model, got Gamma"),
        (lambda x: asp.Inertial(1.0, x), "x", "damping: expected a number, got str"),
        (lambda x: asp.MasterEquation(x), LAW, "contacts: expected Contacts, got Gamma"),
        (lambda x: asp.MasterEquation(CONTACTS, start=x), 1, "start: expected text, got int"),
        (
            lambda x: asp.MasterEquation(CONTACTS).steady_state().force_std(x),
            "x",
            "size: expected a number, got str",
        ),
        (lambda x: asp.read_laboratory(x), 1, "path: expected a path, got int"),
        (lambda x: THEORY.pull(x), np.zeros(5), "distance: expected a number, got ndarray of shape [5]"),
        (lambda x: THEORY.pull(1.0, x), 2.5, "points: expected a whole number, 0 or above, got float"),
        (lambda x: asp.Ensemble(CONTACTS, size=x), "x", "size: expected a whole number, 0 or above, got str"),
        (lambda x: asp.Ensemble(CONTACTS).pull(x), "x", "distance: expected a number, got str"),
        (lambda x: asp.Block(THEORY, x), "x", "stiffness: expected a number, got str"),
        (lambda x: BLOCK.drive(velocity=x), "x", "velocity: expected a number, got str"),
        (
            lambda x: asp.Interface(CONTACTS, [4], connection=x, neighbours=1.0),
            "x",
            "connection: expected a number, got str",
        ),
    ],
)
def test_messages_name_the_argument(call: Callable[[Any], object], wrong: object, message: str) -> None:
    with pytest.raises(TypeError, match=re.escape(message)):
        call(wrong)

"""Every result has a picture: on the axes that are given, in the style of the moment, with labels."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import asperity as asp
import numpy as np
import pytest
from asperity._smooth import along_logarithm
from shipped import SMALLER

matplotlib = pytest.importorskip("matplotlib")

ROOT = Path(__file__).parents[2]
# Those that take more than a second or so; their tasks are among the others, but for those below.
SLOW = {
    "aftershocks",
    "areas",
    "avalanches",
    "fig3",
    "creep",
    "front-ageing",
    "half-space-512",
    "healing",
    "hold-chain",
    "laboratory",
    "renormalised",
    "renormalised-cells",
    "stability",
    "stick-slip-overdamped",
    "velocity-curve-ageing",
    "velocity-curve-mean-field",
    "velocity-curve-thermal",
}
SCENARIOS = [
    path
    for path in sorted(ROOT.glob("scenarios/*.toml"))
    if path.stem not in SLOW and not path.stem.startswith("sweep")
]
WARM = asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=asp.Logarithmic(growth=0.1, time=1.0))
THEORY = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.05)))


@pytest.fixture(autouse=True)
def no_window() -> Iterator[None]:
    import matplotlib.pyplot as plt

    plt.switch_backend("agg")
    with plt.rc_context():
        yield
    plt.close("all")


def drawn(axes: Any) -> bool:
    """Whether anything finite is on the axes."""
    lines = any(np.isfinite(line.get_ydata()).any() for line in axes.lines if len(line.get_ydata()))
    return bool(lines or axes.collections or axes.images or axes.containers)


def check(result: Any) -> None:
    """Every kind of picture is drawn on the given axes, with labels, and can be rendered."""
    import matplotlib.pyplot as plt

    assert result.pictures
    for kind in (None, *result.pictures):
        figure, (left, right) = plt.subplots(1, 2)
        assert result.plot(left, kind=kind) is left
        assert drawn(left)
        assert left.get_xlabel()
        assert left.get_ylabel()
        assert not drawn(right)
        figure.canvas.draw()
        plt.close(figure)


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_every_shipped_scenario_has_pictures(path: Path) -> None:
    check(asp.run(path))


@pytest.mark.parametrize("name", SMALLER)
def test_every_task_has_pictures(name: str) -> None:
    check(asp.run(ROOT / "scenarios" / f"{name}.toml", SMALLER[name]))


def test_every_task_is_among_them() -> None:
    shown = [*SCENARIOS, *(ROOT / "scenarios" / f"{name}.toml" for name in SMALLER)]
    tables = {line.strip("[]") for path in shown for line in path.read_text(encoding="utf-8").split()}
    with pytest.raises(ValueError, match="a task: one of the tables") as refused:
        asp.run({"contacts": {"thresholds": asp.Gaussian(1.0, 0.1)}})
    tasks = set(re.findall(r"\[(\w+)\]", str(refused.value)))
    assert {"pull", "renormalisation"} < tasks
    assert tasks <= tables


def test_objects_have_pictures() -> None:
    pull = THEORY.pull(3.0, 31)
    block = asp.Block(THEORY, 1.0, asp.Inertial(1.0))
    run = block.drive(5.0)
    ensemble = asp.Ensemble(THEORY.contacts, size=100)
    sampled = asp.Block(ensemble, 1.0).drive(5.0)
    assert sampled.sizes is not None
    assert run.slip_course is not None
    for one in (
        pull.stretch_density(1.0),
        pull.stretch_density([0.0, 1.0]),
        THEORY.steady_state(),
        THEORY.relaxation(),
        asp.MasterEquation(asp.Contacts(asp.Point(1.0))).steady_state(),
        block.equilibrium(3.0),
        block.potential([1.0, 2.0], 3.0),
        run.slip_course,
        run.events,
        sampled.sizes,
        WARM,
        asp.Contacts(areas=asp.Areas(asp.Gamma(1.0, 0.5), 1.0, 1.0)),
        THEORY,
        asp.Interface(THEORY.contacts, [4, 4], connection=1.0, neighbours=1.0),
        asp.Lattice(THEORY.contacts, [4, 4], neighbours=0.1, connection=0.1),
        block,
    ):
        _, axes = matplotlib.pyplot.subplots()
        assert one.plot(axes) is axes, one
        assert drawn(axes), one
        matplotlib.pyplot.close("all")
    records: list[Any] = [pull, run, ensemble.pull(3.0, 31, snapshots=[1.0])]
    records.append(asp.Transport(WARM).follow([asp.Step(1.0, distance=2.0)]))
    records.append(
        asp.Interface(THEORY.contacts, [4, 4], connection=1.0, neighbours=1.0).drive(3.0, maps=[1.0])
    )
    for record in records:
        assert drawn(record.plot())


def test_curves_at_several_positions_have_a_legend() -> None:
    block = asp.Block(THEORY, 1.0)
    for several, one, labels in (
        (THEORY.pull(3.0, 31).stretch_density([0.5, 1.0]), THEORY.pull(3.0, 31).stretch_density(0.5), "X"),
        (block.potential([0.5, 1.0], 3.0), block.potential(0.5, 3.0), "X_T"),
    ):
        legend = several.plot().get_legend()
        assert legend is not None
        assert [text.get_text() for text in legend.get_texts()] == [f"${labels}$ = 0.5", f"${labels}$ = 1"]
        assert one.plot().get_legend() is None
        matplotlib.pyplot.close("all")


LAWS: list[asp.Law] = [
    asp.Gaussian(1.0, 0.05),
    asp.Rectangular(0.5, 1.5),
    asp.Lognormal(1.0, 0.5),
    asp.Weibull(0.5, 1.0),
    asp.Point(1.0),
    asp.Point(0.0),
    asp.Mixture([(0.25, asp.Point(0.7)), (0.75, asp.Gaussian(1.0, 0.1))]),
    asp.Tabulated(samples=[0.8, 1.0, 1.1]),
]


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_distributions_have_pictures(law: asp.Law) -> None:
    _, axes = matplotlib.pyplot.subplots()
    assert law.plot(axes, color="red") is axes
    axes.figure.canvas.draw()
    assert axes.get_ylabel() == "probability density $p$"
    x, density = (np.array(values) for values in axes.lines[0].get_data())
    # The curve has the mass between the quantiles of 0.1 %; of Weibull, some at its pole.
    mass = np.trapezoid(np.nan_to_num(density), x) if hasattr(np, "trapezoid") else None
    expected = 1.0 - law.atoms.weight.sum()
    if mass is not None and law != asp.Weibull(0.5, 1.0):
        # 0.2 % beyond the ends, and the trapezoidal rule.
        assert mass == pytest.approx(expected, abs=4e-3)
    at = np.array(axes.lines[1].get_xdata())
    # Half of the mass is on either side of the dot in the middle.
    assert np.all(np.isin(at, law.ppf([0.05, 0.5, 0.95])))
    assert len(at) == (3 if expected == 1.0 else 2 if expected > 0.0 else 0)
    assert axes.lines[0].get_color() == "red"
    # A point mass is a stem, without a line of density 0.
    assert (len(x) == 0) == (expected == 0.0)


# What is described or is a few numbers has no picture of its own.
WITHOUT_PICTURE = {
    "Ageing",
    "Areas",
    "Atoms",
    "Correlation",
    "Damped",
    "Description",
    "DistributionDistance",
    "Drift",
    "Dropped",
    "Energy",
    "Estimate",
    "Event",
    "Explorer",
    "FrictionEstimates",
    "FrozenRank",
    "HealingLaw",
    "Inertial",
    "InterfaceEnergy",
    "Label",
    "Logarithmic",
    "MachineHealing",
    "MachineStep",
    "MeanField",
    "MeasuredNoise",
    "Misfit",
    "Motion",
    "PosteriorNumber",
    "SimulatedStickSlip",
    "Simulation",
    "Smoluchowski",
    "Stability",
    "State",
    "StaticFriction",
    "Step",
    "StickSlipStability",
    "Temperature",
    "VelocityLimits",
    "WithError",
}


def test_every_result_and_task_has_plot() -> None:
    classes = {name for name in asp.__all__ if isinstance(getattr(asp, name), type)}
    assert {name for name in classes if not hasattr(getattr(asp, name), "plot")} == WITHOUT_PICTURE


def test_derivatives_predictions_and_spots_have_pictures() -> None:
    pull = THEORY.pull(3.0, 31)
    by_mean = pull.gradient("thresholds.mean")
    line = by_mean.plot().lines[0]
    np.testing.assert_array_equal(line.get_ydata(), by_mean(pull.position))
    of_friction = pull.friction_gradient("thresholds.mean")
    axes = of_friction.plot(color="red")
    bars: list[Any] = list(axes.patches)
    heights = [bar.get_height() for bar in bars]
    kept = (of_friction.static_friction, of_friction.kinetic_friction)
    assert heights == [*kept, of_friction.relaxation_length, of_friction.critical_stiffness]
    assert axes.get_xlabel()
    assert axes.get_ylabel()
    response = pull.threshold_response(np.linspace(0.8, 1.2, 9))
    axes = response.plot()
    assert len(axes.lines) == 7
    np.testing.assert_array_equal(axes.lines[-1].get_ydata(), response(pull.position)[-1])
    position = np.linspace(0.0, 2.0, 41)
    force = THEORY.pull(2.0, 41).force + 0.01 * np.sin(50.0 * position)
    fit = asp.fit(THEORY.contacts, position, force, free=("thresholds.mean",), noise="white")
    predicted = fit.predict([0.5, 1.0])
    assert predicted.position.tolist() == [0.5, 1.0]
    np.testing.assert_array_equal(predicted.plot().lines[0].get_ydata(), predicted.force)
    x = np.arange(32) - 15.5
    map_of = np.sqrt(np.maximum(1.0 - (x[:, None] ** 2 + x**2) / 100.0, 0.0))
    map_of[0:2, 0:3] = 0.05
    found = asp.spots(map_of, pixel=0.5, periodic=False)
    axes = found.plot()
    shown: Any = np.ma.filled(np.ma.asarray(axes.images[0].get_array()), np.nan)
    assert np.nansum(shown == found.load[1]) == np.count_nonzero(found.labels == 2)
    assert axes.get_xlim() == (0.0, 16.0)


def test_a_picture_shows_the_numbers_of_the_result() -> None:
    result = asp.run(ROOT / "scenarios" / "healing.toml", SMALLER["healing"])
    axes = result.plot()
    computed, fitted = (np.array(line.get_xydata()) for line in axes.lines[:2])
    np.testing.assert_array_equal(computed, np.c_[result["hold"], result["static_friction"]])
    # The fitted line is that of the summary. The largest residual of 5 points is below √5 times the mean one.
    at = np.interp(np.log(result["hold"]), np.log(fitted[:, 0]), fitted[:, 1])
    reported = result.summary["hold_curve"]
    span = np.ptp(result["static_friction"])
    assert np.max(np.abs(at - result["static_friction"])) < 2.5 * reported["residual_relative"] * span + 1e-5
    assert axes.get_xscale() == "log"
    assert axes.get_ylabel() == "$F_s$"


def test_maps_show_the_drive_that_is_asked_for() -> None:
    interface = asp.Interface(THEORY.contacts, [3, 4], connection=1.0, neighbours=1.0, disorder=0.1)
    result = interface.drive(3.0, maps=[0.5, 2.0])
    for at in (0.5, 2.0):
        axes = result.plot(kind="map", at=at)
        shown = np.asarray(axes.images[0].get_array())
        (number,) = np.flatnonzero(result["map_drive"] == at)[:1]
        np.testing.assert_array_equal(shown, result["cell_force"][number])
        # A cell is as wide as it is high.
        assert axes.get_aspect() == 1.0


def test_styles_of_matplotlib_are_followed() -> None:
    import matplotlib.pyplot as plt
    from cycler import cycler

    with plt.style.context("dark_background"):
        result = asp.run(ROOT / "scenarios" / "compared.toml")
        axes = result.plot()
        (measured,) = (line for line in axes.lines if line.get_label() == "measured")
        assert measured.get_color() == "white"
    plt.rcParams["axes.prop_cycle"] = cycler(color=["#123456"])
    assert result.plot().lines[0].get_color() == "#123456"
    assert result.plot(color="red", linewidth=3).lines[0].get_color() == "red"


def test_a_kind_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match=r"plot\.kind: expected one of force, .*got map"):
        asp.run(ROOT / "scenarios" / "fig2.toml", {"ensemble.size": 10}).plot(kind="map")
    pull = asp.MasterEquation(asp.Contacts(thresholds=asp.Gaussian(1.0, 0.1))).pull(distance=1.0)
    with pytest.raises(ValueError, match=r"plot\.kind: expected force, got map"):
        pull.plot(kind="map")
    assert [pull.plot(kind=kind).get_ylabel() for kind in pull.pictures] == [pull.plot().get_ylabel()]


def test_units_are_on_the_axes() -> None:
    axes = asp.run(ROOT / "scenarios" / "compared.toml").plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("$X$ (µm)", "$F$ (N)")


def test_velocity_curves_are_smooth_and_meet_their_points() -> None:
    x = np.geomspace(1e-3, 10.0, 9)
    y = 0.3 + 0.02 * np.log1p(10.0 * x)
    at, curve = along_logarithm(x, y)
    assert len(at) == 8 * 24 + 1
    np.testing.assert_array_equal(at[::24], x)
    np.testing.assert_allclose(curve[::24], y, rtol=1e-15)
    # Between points a cubic with slopes of second order; straight pieces are off by 1e-3.
    np.testing.assert_allclose(curve, 0.3 + 0.02 * np.log1p(10.0 * at), atol=3e-4)
    assert np.all(np.diff(curve) > 0.0)
    # A step: nothing beyond its ends.
    _, step = along_logarithm(x, np.where(x < 0.1, 0.0, 1.0))
    assert (step.min(), step.max()) == (0.0, 1.0)

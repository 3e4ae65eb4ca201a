"""The models: numbers of the theory, agreement of one with the other and with closed forms."""

import math
import sys
from collections.abc import Callable, Mapping

import asperity as asp
import numpy as np
import pytest

FIGURE_2 = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.05)), asp.Gaussian(0.1, 0.025))


@pytest.fixture(scope="module")
def pull() -> asp.Pull:
    return FIGURE_2.pull(distance=20.0, points=2001)


def test_the_numbers_of_figure_2(pull: asp.Pull) -> None:
    assert pull.static_friction is not None
    # The default tolerance is 1e-10 of F; a flat maximum has its root, a critical stiffness is a slope.
    assert pull.static_friction.force == pytest.approx(0.868081709809, abs=1e-9)
    assert pull.static_friction.position == pytest.approx(0.791756131650, abs=1e-7)
    assert pull.kinetic_friction == pytest.approx(0.50125, abs=1e-12)
    assert pull.relaxation_length == pytest.approx(20.2704854183, abs=1e-8)
    assert pull.critical_stiffness == pytest.approx(6.143821037, abs=1e-6)
    assert pull.force[[109, 500, 2000]] == pytest.approx([0.190395432031, 0.297307166, 0.432329275], abs=1e-9)


def test_arrays_are_those_asked_for(pull: asp.Pull) -> None:
    assert pull.position.shape == pull.force.shape == pull.breaking_rate.shape == (2001,)
    assert (pull.position[0], pull.position[-1], pull.distance) == (0.0, 20.0, 20.0)
    assert pull.equation == FIGURE_2
    np.testing.assert_array_equal(pull(pull.position), pull.force)
    np.testing.assert_array_equal(pull.force_at(pull.position.reshape(3, 667)).ravel(), pull.force)
    np.testing.assert_array_equal(pull.breaking_rate_at(pull.position), pull.breaking_rate)
    with pytest.raises(ValueError, match="read-only"):
        pull.force[0] = 1.0


def test_the_slope_is_that_of_the_force(pull: asp.Pull) -> None:
    x, step = np.linspace(0.5, 19.5, 50), 1e-4
    # Third derivatives are some 1e3 in units of the thresholds, the error of F is 1e-10.
    difference = (pull(x + step) - pull(x - step)) / (2.0 * step)
    np.testing.assert_allclose(pull.slope_at(x), difference, atol=1e3 * step**2 + 1e-10 / step)


def test_stretches_add_up_to_one_and_to_the_force(pull: asp.Pull) -> None:
    stretches = np.linspace(0.0, 1.5, 6001)
    several = pull.stretch_density(at=[0.0, 1.09, 2.18], stretches=stretches)
    assert several.density.shape == (3, 6001)
    assert several.position is not None
    assert several.position.tolist() == [0.0, 1.09, 2.18]
    single = pull.stretch_density(at=1.09, stretches=stretches)
    np.testing.assert_array_equal(single.density, several.density[1])
    assert single.position is None
    # The trapezoidal rule on densities that jump at 0: its error is a step times the jump, at most 20.
    step = stretches[1]
    mass = several.density.sum(axis=1) * step
    assert mass == pytest.approx([1.0, 1.0, 1.0], abs=20.0 * step)
    force = (several.density @ stretches) * step
    assert force == pytest.approx(pull([0.0, 1.09, 2.18]), abs=1e-4)
    assert pull.stretch_density(at=1.0).stretch.size > 400


def test_point_masses_are_listed() -> None:
    pull = asp.MasterEquation(asp.Contacts(asp.Point(1.0)), asp.Point(0.25)).pull(2.0)
    np.testing.assert_allclose(pull.breaking_atoms.position, [0.75, 1.75], rtol=1e-12)
    np.testing.assert_allclose(pull.breaking_atoms.weight, [1.0, 1.0], rtol=1e-12)
    first, second = pull.stretch_density(at=[0.5, 1.0]).atoms
    assert isinstance(first, asp.Atoms)
    assert isinstance(second, asp.Atoms)
    assert (first.position[0], second.position[0]) == pytest.approx((0.75, 0.25), abs=1e-12)
    assert pull.critical_stiffness == np.inf
    assert FIGURE_2.pull(0.5).static_friction is None


def test_closed_forms() -> None:
    x = np.linspace(0.0, 10.0, 101)
    for thresholds, form in (
        (asp.Gaussian(1.0, 0.05), asp.exact.Gaussian(1.0, 0.05)),
        (asp.Rectangular(0.5, 1.5), asp.exact.Rectangular(0.5, 1.5)),
        (asp.Gamma(1.0, 0.25), asp.exact.Erlang(16, 16.0)),
        (asp.Gamma(1.0, 0.23), asp.exact.Gamma(1.0, 0.23)),
    ):
        pull = asp.MasterEquation(asp.Contacts(thresholds)).pull(10.0)
        # The default tolerance is 1e-10 of the mean threshold. A critical stiffness is a slope.
        np.testing.assert_allclose(pull(x), form.force(x), atol=1e-9)
        np.testing.assert_allclose(pull.kinetic_friction, form.kinetic_friction, rtol=1e-9)
        assert pull.static_friction is not None
        assert form.static_friction is not None
        assert pull.static_friction.force == pytest.approx(form.static_friction.force, abs=1e-9)
        assert pull.critical_stiffness == pytest.approx(form.critical_stiffness, rel=1e-6)
    assert asp.exact.Erlang(4, 4.0).static_friction is None
    assert asp.exact.Identical(1.0).force([0.5, 1.0, 2.25]) == pytest.approx([0.5, 0.0, 0.25])
    assert asp.exact.Identical(1.0).critical_stiffness == np.inf


def test_the_period_of_stick_slip_over_rectangular_thresholds() -> None:
    model = asp.MasterEquation(asp.Contacts(asp.Rectangular(0.7, 1.3)))
    run = asp.Block(model, stiffness=0.5, slip="reset").drive(20.0)
    form = asp.exact.Rectangular(0.7, 1.3)
    # The default tolerance is 1e-10 of the mean threshold.
    assert np.diff(run["event_drive"]) == pytest.approx(form.stick_slip_period(0.5), abs=1e-9)
    assert form.stick_slip_period(1.2) is None


def test_steady_sliding() -> None:
    contacts = asp.Contacts(asp.Rectangular(0.8, 1.2), asp.Rectangular(0.0, 0.2), count=10, stiffness=3.0)
    steady = asp.MasterEquation(contacts).steady_state()
    # The default tolerance is 1e-10 of the mean threshold.
    assert steady.kinetic_friction == pytest.approx(30.0 * 5.0 / 9.0, rel=1e-9)
    assert steady.breaking_rate == pytest.approx(1.0 / 0.9, rel=1e-9)
    law = asp.Gaussian(1.0, 0.05)
    steady = asp.MasterEquation(asp.Contacts(law)).steady_state()
    assert steady.force_std(100) == pytest.approx(np.sqrt(asp.exact.steady_variance(law) / 100), rel=1e-9)
    assert asp.exact.kinetic_friction(law) == pytest.approx(steady.kinetic_friction, rel=1e-9)
    x = np.array([0.1, 0.9, 1.0])
    # Q_s = S/x̄.
    np.testing.assert_allclose(steady.stretch_density(x).density, law.sf(x) / law.mean(), rtol=1e-9)


def test_relaxation(pull: asp.Pull) -> None:
    relaxation = FIGURE_2.relaxation()
    exact = asp.exact.Gaussian(1.0, 0.05)
    # The default tolerance is 1e-10 of the mean threshold.
    assert relaxation.length == pytest.approx(exact.relaxation_length, rel=1e-9)
    assert relaxation.paper_estimate == pytest.approx(20.0)
    assert relaxation.roots[0] == pytest.approx(exact.relaxation_root(1), rel=1e-9)
    x = np.linspace(relaxation.valid_from, 20.0, 20)
    np.testing.assert_allclose(relaxation.force(x), pull(x), atol=1e-9)


def test_the_ensemble_agrees_with_the_master_equation(pull: asp.Pull) -> None:
    ensemble = asp.Ensemble(FIGURE_2.contacts, FIGURE_2.initial, size=100_000, seed=1)
    sample = ensemble.pull(20.0, 201, snapshots=[0.0, 1.09], edges=np.linspace(0.0, 1.3, 14))
    # Four standard errors at 201 places.
    assert np.all(np.abs(sample.force - pull(sample.position)) < 4.0 * sample.force_error)
    np.testing.assert_allclose(sample.force_error, pull.force_std(100_000, sample.position), rtol=0.03)
    assert sample["stretch_density"].shape == (2, 13)
    np.testing.assert_allclose(sample["stretch_density"].sum(axis=1) * 0.1, 1.0, rtol=1e-12)
    assert sample.ensemble == ensemble
    assert abs(sample.breaks - 20.0 * 100_000) < 0.03 * 20.0 * 100_000


def test_the_ensemble_is_that_of_its_seed() -> None:
    contacts = asp.Contacts(asp.Gamma(1.0, 0.2))
    pulls = [asp.Ensemble(contacts, size=1000, seed=seed).pull(5.0, 11) for seed in (1, 1, 2)]
    np.testing.assert_array_equal(pulls[0].force, pulls[1].force)
    assert not np.array_equal(pulls[0].force, pulls[2].force)
    drawn = asp.Ensemble(contacts, size=10, seed=np.random.default_rng(3)).seed
    assert drawn == np.random.default_rng(3).integers(2**63)


def test_quenched_contacts_keep_their_thresholds() -> None:
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.05))
    sample = asp.Ensemble(contacts, size=100_000, disorder="quenched").pull(12.5, 3)
    exact = asp.exact.Quenched(asp.Gaussian(1.0, 0.05))
    assert exact.force(6.25) == pytest.approx(0.452365, abs=1e-6)
    assert np.all(np.abs(sample.force[1:] - exact.force(sample.position[1:])) < 4.0 * sample.force_error[1:])


def test_areas_give_thresholds_and_stiffnesses() -> None:
    """Contacts of area 4: k = 2√4 = 4 breaks at the force 3 × 4 = 12, so at the stretch 3."""
    contacts = asp.Contacts(areas=asp.Areas(asp.Point(4.0), modulus=2.0, strength=3.0))
    pull = asp.MasterEquation(contacts).pull(4.0)
    assert pull.static_friction is not None
    assert pull.static_friction == pytest.approx((12.0, 3.0))


def test_a_record_is_a_mapping(pull: asp.Pull) -> None:
    assert isinstance(pull, Mapping)
    assert list(pull) == list(pull.keys()) == ["position", "force", "breaking_rate"]
    assert len(pull) == 3
    assert "force" in pull
    assert "nothing" not in pull
    assert pull["force"] is pull.force
    assert pull.get("nothing") is None
    assert dict(pull.items())["force"] is pull.force
    with pytest.raises(KeyError, match="expected one of position, force, breaking_rate, got nothing"):
        pull["nothing"]
    assert pull.labels["force"] == (("position",), "friction force", "1", "force")


def test_results_are_shown(pull: asp.Pull) -> None:
    assert "0.868082 at 0.791756" in repr(pull)
    assert "<caption>Pull</caption>" in pull._repr_html_()
    assert "not reached" in repr(FIGURE_2.pull(0.5))
    assert repr(FIGURE_2.relaxation()).startswith("<relaxation: X* = 20.27")
    assert repr(FIGURE_2.steady_state()).startswith("<steady sliding: F_k = 0.50125")


def test_progress_is_reported(capsys: pytest.CaptureFixture[str]) -> None:
    heard: list[float] = []
    contacts = asp.Contacts(asp.Gaussian(1.0, 0.05))
    asp.Ensemble(contacts, size=1_000_000).pull(20.0, progress=heard.append)
    assert len(heard) > 1
    assert heard[-1] == 1.0
    assert heard == sorted(heard)
    assert all(0.0 <= fraction <= 1.0 for fraction in heard)


def test_an_error_in_the_listener_stops_the_work() -> None:
    def listen(fraction: float) -> None:
        raise LookupError(fraction)

    with pytest.raises(LookupError):
        asp.Ensemble(asp.Contacts(asp.Gaussian(1.0, 0.05)), size=10_000_000).pull(20.0, progress=listen)


def test_a_bar_shows_progress(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("tqdm")
    FIGURE_2.pull(progress=True)
    assert "100%" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("module", "call", "extra"),
    [
        ("tqdm.auto", lambda pull: pull.equation.pull(progress=True), "pip install tqdm"),
        ("xarray", lambda pull: pull.to_xarray(), r"pip install 'asperity\[xarray\]'"),
        ("matplotlib.pyplot", lambda pull: pull.plot(), r"pip install 'asperity\[plot\]'"),
    ],
)
def test_what_is_missing_is_named(
    module: str,
    call: Callable[[asp.Pull], object],
    extra: str,
    pull: asp.Pull,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=extra):
        call(pull)


def test_labelled_arrays(pull: asp.Pull) -> None:
    pytest.importorskip("xarray")
    data = pull.to_xarray()
    assert data["force"].dims == ("position",)
    described = {"long_name": "friction force", "units": "1", "quantity": "force"}
    assert data["force"].attrs == described
    assert data.attrs["version"] == asp.__version__
    assert data.attrs["kinetic_friction"] == pull.kinetic_friction
    assert "position" in data.coords
    np.testing.assert_array_equal(data["force"].values, pull.force)


def test_pictures(pull: asp.Pull) -> None:
    pytest.importorskip("matplotlib")
    axes = pull.plot(color="k")
    curve, peak, steady = (np.array(line.get_xydata()) for line in axes.lines)
    np.testing.assert_array_equal(curve, np.column_stack([pull.position, pull.force]))
    assert pull.static_friction is not None
    assert tuple(peak[0]) == (pull.static_friction.position, pull.static_friction.force)
    assert steady[0, 1] == pull.kinetic_friction
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("$X$", "$F$")
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["$F_s$", "$F_k$"]
    sample = asp.Ensemble(FIGURE_2.contacts, size=10).pull(5.0, 11)
    assert sample.plot(axes) is axes
    assert len(axes.lines) == 4
    # With a label of its own, a curve is named alone.
    named = pull.plot(label="mine")
    assert named.get_legend_handles_labels()[1] == ["mine"]
    assert named.get_legend() is None


def test_stretches_beyond_the_thresholds_are_left_out_with_a_warning() -> None:
    contacts = asp.Contacts(asp.Delta(1.0), asp.Exponential(0.5))
    with pytest.warns(UserWarning, match=r"contacts\.reforming: a fraction of 1\.353e-1 is left out"):
        model = asp.MasterEquation(contacts)
    # ⟨1 − r²⟩/(2⟨1 − r⟩) over the r < 1 of an exponential distribution.
    q = 1.0 / math.expm1(2.0)
    # The accuracy of lives, 1e-13 per mean life.
    assert abs(model.steady_state().kinetic_friction - 0.5 * (0.5 + 2.0 * q) / (0.5 + q)) < 1e-12
    with pytest.raises(ValueError, match="reforming"):
        asp.MasterEquation(asp.Contacts(asp.Delta(1.0), asp.Exponential(2.0)))

"""Covariance, noise of steady sliding and derivatives, against closed forms of exponential thresholds."""

from typing import Any

import asperity as asp
import numpy as np
import pytest

# F = 1 − exp(−X) per unit stiffness of all contacts, of which there are 400.
CONTACTS = asp.Contacts(asp.Exponential(1.0), count=400.0, stiffness=0.5)
EQUATION = asp.MasterEquation(CONTACTS)
SCALE = 400 * 0.5


def test_covariance_of_exponential_thresholds() -> None:
    pull = EQUATION.pull(5.0)
    at = np.array([2.0, 0.5, 4.5, 0.0])
    low, high = np.minimum.outer(at, at), np.maximum.outer(at, at)
    exact = np.exp(low - high) - 2 * low * np.exp(-high) - np.exp(-low - high)
    # The default aim of the solution is 1e-10; the sum has some ten terms of order 1.
    np.testing.assert_allclose(pull.covariance(at) * 400 / SCALE**2, exact, atol=1e-9)
    np.testing.assert_allclose(pull.covariance(at, 25) * 25 / SCALE**2, exact, atol=1e-9)
    assert pull.covariance(at)[3, 3] == 0


def test_sample_paths_are_those_of_a_seed() -> None:
    pull = EQUATION.pull(5.0)
    at = np.linspace(0.5, 4.5, 9)
    paths = pull.sample_paths(at, 2000, seed=5)
    assert paths.shape == (2000, 9)
    assert np.array_equal(paths, pull.sample_paths(at, 2000, seed=5))
    assert not np.array_equal(paths, pull.sample_paths(at, 2000, seed=6))
    # six standard errors of a mean
    error = pull.force_std(400, at) / np.sqrt(2000)
    assert np.all(np.abs(paths.mean(axis=0) - pull(at)) < 6 * error)
    with pytest.raises(ValueError, match=r"at\.1: expected a position from 0 to 5"):
        pull.sample_paths([1.0, 6.0], 1, seed=1)


def test_a_plot_shows_the_scatter_of_few_contacts() -> None:
    pytest.importorskip("matplotlib")
    pull = EQUATION.pull(5.0, 101)
    axes = pull.plot(size=50, paths=3, seed=1, color="k")
    # F(X) and F_k; F of exponential thresholds has no maximum.
    curve, _, *paths = (np.array(line.get_xydata()) for line in axes.lines)
    np.testing.assert_array_equal(curve, np.column_stack([pull.position, pull.force]))
    assert len(paths) == 3
    at = paths[0][:, 0]
    np.testing.assert_array_equal(
        np.array([path[:, 1] for path in paths]), pull.sample_paths(at, 3, 50, seed=1)
    )
    (band,) = axes.collections
    edges = np.asarray(band.get_paths()[0].vertices)
    width = np.max(edges[edges[:, 0] == 5.0, 1]) - np.min(edges[edges[:, 0] == 5.0, 1])
    assert width == pytest.approx(2 * pull.force_std(50, 5.0))
    # Each is named once.
    names = ["$F_k$", "± std", "sample paths"]
    assert axes.get_legend_handles_labels()[1] == names
    # Without a size the N_c contacts; without either neither band nor paths.
    several = pull.plot(axes, paths=2, seed=1)
    assert (len(several.lines), len(several.collections)) == (9, 2)
    assert several.get_legend_handles_labels()[1] == names
    plain = pull.plot()
    assert (len(plain.lines), len(plain.collections)) == (2, 0)
    refused: list[tuple[dict[str, Any], str]] = [
        ({"paths": 2}, "seed"),
        ({"size": 0.0}, "size"),
        ({"paths": -1, "seed": 1}, "paths"),
    ]
    for wrong, key in refused:
        with pytest.raises(ValueError, match=f"^{key}: expected"):
            pull.plot(**wrong)


def test_noise_of_steady_sliding() -> None:
    steady = EQUATION.steady_state()
    u = np.linspace(0.0, 6.0, 13).reshape(13, 1)
    exact = SCALE**2 / 400 * np.exp(-u)
    # The default tolerance is 1e-10 of the mean threshold.
    np.testing.assert_allclose(steady.autocovariance(u), exact, atol=1e-9 * SCALE**2 / 400)
    q = np.array([0.0, 0.1, 3.0, 200.0])
    np.testing.assert_allclose(steady.spectrum(q), 2 * SCALE**2 / 400 / (1 + q**2), rtol=1e-9)
    assert isinstance(steady.spectrum(1.0), float)
    assert isinstance(steady.autocovariance(1.0, size=10), float)
    with pytest.raises(ValueError, match="lines"):
        asp.MasterEquation(asp.Contacts(asp.Point(1.0))).steady_state().spectrum(1.0)
    with pytest.raises(ValueError, match=r"wave_number\.0"):
        steady.spectrum([-1.0])


def test_derivatives_of_exponential_thresholds() -> None:
    pull = EQUATION.pull(5.0)
    gradient = pull.gradient("thresholds.mean")
    assert gradient.parameter == "thresholds.mean"
    x = np.linspace(0.0, 5.0, 21)
    exact = SCALE * (1 - np.exp(-x) * (1 + x))
    # A derivative follows the force with a digit or two less than its default tolerance of 1e-10.
    np.testing.assert_allclose(gradient(x), exact, atol=1e-8 * SCALE)
    friction = pull.friction_gradient("thresholds.mean")
    # Steady sliding is integrated to rounding, of which derivatives lose some digits.
    assert friction.kinetic_friction == pytest.approx(SCALE, rel=1e-10)
    assert friction.static_friction is None
    assert friction.critical_stiffness == 0
    assert list(pull.parameters()) == ["thresholds.mean", "count", "stiffness"]
    together = pull.gradients(list(pull.parameters()))
    np.testing.assert_allclose(together[0](x), exact, atol=1e-8 * SCALE)
    np.testing.assert_allclose(together[1](x) * pull.parameters()["count"], pull(x), atol=1e-10 * SCALE)
    for wrong in ("mean", "thresholds.std", "reforming.at"):
        with pytest.raises(ValueError, match="expected"):
            pull.gradient(wrong)


def test_response_to_thresholds() -> None:
    pull = EQUATION.pull(5.0)
    thresholds = np.array([0.5, 2.0, 9.0])
    response = pull.threshold_response(thresholds)
    np.testing.assert_array_equal(response.thresholds, thresholds)
    x = np.linspace(0.0, 5.0, 12).reshape(3, 4)
    xi = thresholds[:, None, None]
    exact = SCALE * np.where(x < xi, x**2 / 2, xi**2 / 2 - xi)
    # The default tolerance is 1e-10 of the mean threshold.
    np.testing.assert_allclose(response(x), exact, atol=1e-9 * SCALE)
    assert response(1.0).shape == (3,)
    weights = np.linspace(-1.0, 1.0, 12)
    np.testing.assert_allclose(
        response.adjoint(x.ravel(), weights), response(x.ravel()) @ weights, atol=1e-9 * SCALE
    )
    assert "3 thresholds" in repr(response)
    with pytest.raises(ValueError, match=r"position\.0"):
        response([5.1])
    with pytest.raises(ValueError, match="weights"):
        response.adjoint([1.0], [1.0, 2.0])
    with pytest.raises(ValueError, match="thresholds"):
        pull.threshold_response([-1.0])


def test_friction_gradients_together() -> None:
    pull = EQUATION.pull(5.0)
    names = list(pull.parameters())
    for name, found in zip(names, pull.friction_gradients(names), strict=True):
        # The same numbers through another call: solutions to 1e-10.
        assert found.kinetic_friction == pytest.approx(
            pull.friction_gradient(name).kinetic_friction, rel=1e-9
        )

"""Draws from the posterior of a fit."""

import json
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import asperity as asp
import numpy as np
import pytest

POSITION = np.linspace(0.03, 4.5, 150)
NAMES = ("thresholds.mean", "thresholds.std", "count")
TRUE = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000.0)
FORCE = asp.MasterEquation(TRUE).pull(4.5)(POSITION) + 5.0 * np.random.default_rng(2).standard_normal(150)
FIT = asp.fit(TRUE, POSITION, FORCE, free=NAMES, noise="white", reading=5.0)
POSTERIOR = FIT.sample(draws=400, chains=4, seed=3)


def test_a_curve_that_determines_its_numbers_has_the_posterior_of_the_estimates() -> None:
    assert list(POSTERIOR.params) == list(NAMES)
    assert POSTERIOR.divergences == 0
    for name, one in POSTERIOR.params.items():
        estimate = FIT.params[name]
        # Four standard errors of the mean and of the standard deviation of as many draws, and 5 % since
        # the likelihood is not quite normal.
        assert abs(one.mean - estimate.value) < (4 / np.sqrt(one.ess) + 0.05) * estimate.error, name
        assert abs(one.std / estimate.error - 1) < 4 / np.sqrt(2 * one.ess) + 0.05, name
        draws = POSTERIOR.draws[name]
        assert draws.shape == (4, 400)
        assert one.mean == pytest.approx(draws.mean(), rel=1e-12)
        assert one.std == pytest.approx(draws.std(ddof=1), rel=1e-9)
        found = (one.interval[0], one.median, one.interval[1])
        np.testing.assert_allclose(found, np.quantile(draws, [0.025, 0.5, 0.975]))


def test_the_density_is_that_of_the_likelihood() -> None:
    draw = [POSTERIOR.draws[name][1, 7] for name in NAMES]
    # The same likelihood through another call: solutions to 1e-10.
    assert POSTERIOR.log_density[1, 7] == pytest.approx(FIT.log_likelihood(draw)[0], rel=1e-9)


def test_draws_are_pickled() -> None:
    again = pickle.loads(pickle.dumps(POSTERIOR))
    assert again.params == POSTERIOR.params
    assert again.divergences == POSTERIOR.divergences
    for name in NAMES:
        np.testing.assert_array_equal(again.draws[name], POSTERIOR.draws[name])


def test_the_same_seed_gives_the_same_draws() -> None:
    first, again, other = (FIT.sample(draws=8, chains=2, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.draws["count"], again.draws["count"])
    assert (first.draws["count"] != other.draws["count"]).any()
    # So few draws are not enough, and this is reported.
    assert first.warnings
    assert first.warnings[0] in first.summary()


def test_the_summary_has_a_row_for_each_number() -> None:
    text = POSTERIOR.summary()
    assert text.startswith("4 chains of 400 draws from the posterior\n  thresholds.mean ")
    assert text.count("ESS") == 3
    assert repr(POSTERIOR).startswith("<asperity.Posterior>\n")
    assert "<table><caption>Posterior</caption>" in POSTERIOR._repr_html_()


@pytest.mark.parametrize("version", ["0.21.0", "1.2.0"])
def test_arviz_gets_its_groups(version: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a module in the place of arviz, with the two forms that its from_dict has had."""

    def old(posterior: dict[str, Any], sample_stats: dict[str, Any]) -> dict[str, Any]:
        return {"posterior": posterior, "sample_stats": sample_stats}

    def new(groups: dict[str, Any]) -> dict[str, Any]:
        return groups

    arviz = ModuleType("arviz")
    monkeypatch.setattr(arviz, "__version__", version, raising=False)
    monkeypatch.setattr(arviz, "from_dict", new if version.startswith("1") else old, raising=False)
    monkeypatch.setitem(sys.modules, "arviz", arviz)
    groups = POSTERIOR.to_arviz()
    np.testing.assert_array_equal(groups["posterior"]["count"], POSTERIOR.draws["count"])
    np.testing.assert_array_equal(groups["sample_stats"]["lp"], POSTERIOR.log_density)
    assert groups["sample_stats"]["diverging"].dtype == bool


def test_arviz_has_the_same_diagnostics() -> None:
    arviz = pytest.importorskip("arviz")
    groups = POSTERIOR.to_arviz()
    r_hat, ess = arviz.rhat(groups), arviz.ess(groups)
    for name, one in POSTERIOR.params.items():
        # The same ranks, summed in another order.
        assert one.r_hat == pytest.approx(float(r_hat[name]), rel=1e-9), name
        assert one.ess == pytest.approx(float(ess[name]), rel=1e-6), name
    assert int(groups["sample_stats"]["diverging"].sum()) == POSTERIOR.divergences


def test_arviz_opens_the_file_of_draws(tmp_path: Path) -> None:
    arviz = pytest.importorskip("arviz")
    rows = np.column_stack([POSITION, FORCE])
    np.savetxt(tmp_path / "measured.csv", rows, delimiter=",", header="position,force", comments="")
    scenario = {
        "contacts": {"count": 1000.0, "thresholds": asp.Gaussian(1.0, 0.2)},
        "fit": {
            "file": str(tmp_path / "measured.csv"),
            "free": ["contacts.thresholds.gaussian.mean", "contacts.count"],
            "noise": "white",
            "reading": 5.0,
            "posterior": {"draws": 40, "chains": 2, "seed": 1},
        },
    }
    asp.run(scenario, folder=tmp_path / "out")
    groups = arviz.from_netcdf(tmp_path / "out" / "posterior.nc")
    told = json.loads((tmp_path / "out" / "fit.json").read_text())["posterior"]["numbers"]
    assert {one["key"] for one in told} == set(groups["posterior"].data_vars)
    r_hat = arviz.rhat(groups)
    for one in told:
        draws = groups["posterior"][one["key"]]
        assert draws.sizes == {"chain": 2, "draw": 40}
        # Sums in another order.
        assert one["mean"] == pytest.approx(float(draws.mean()), rel=1e-12)
        # The same ranks, summed in another order.
        assert one["r_hat"] == pytest.approx(float(r_hat[one["key"]]), rel=1e-9)
    assert groups["sample_stats"]["diverging"].sizes == {"chain": 2, "draw": 40}


def test_without_arviz_the_package_to_install_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "arviz", None)
    with pytest.raises(ImportError, match=r"^to_arviz\(\) needs arviz: pip install arviz$"):
        POSTERIOR.to_arviz()


def test_pairs_of_numbers_are_plotted() -> None:
    pytest.importorskip("matplotlib")
    axes = POSTERIOR.plot()
    assert axes.shape == (3, 3)
    (points,) = axes[2, 0].lines
    np.testing.assert_array_equal(points.get_xdata(), POSTERIOR.draws["thresholds.mean"].ravel())
    assert axes[2, 0].get_xlabel() == "thresholds.mean"
    assert not axes[0, 2].axison


def numbers(axis: Any) -> list[str]:
    """The numbers that are shown at an axis."""
    return [tick.label1.get_text() for tick in axis.get_major_ticks() if tick.label1.get_visible()]


@pytest.mark.parametrize(("place", "width"), [(0.002, 3e-6), (1.0, 0.1), (3e8, 1e5), (0.0, 1e-9)])
def test_numbers_beside_pairs_do_not_meet(place: float, width: float) -> None:
    pytest.importorskip("matplotlib")
    from asperity._plot import corner

    random = np.random.default_rng(4)
    draws = {name: place + width * random.standard_normal((2, 300)) for name in "abcde"}
    axes = corner(SimpleNamespace(draws=draws))  # type: ignore[arg-type]
    figure = axes[0, 0].figure
    figure.canvas.draw()
    below = [text for column in range(5) for text in numbers(axes[4, column].xaxis)]
    beside = [text for row in range(1, 5) for text in numbers(axes[row, 0].yaxis)]
    assert min(len(below), len(beside)) >= 8
    # Texts are the numbers: of as many digits as tell them apart, and nothing is added to them.
    axis = axes[4, 0].xaxis
    places = axis.get_majorticklocs()
    read = [float(text.replace("\N{MINUS SIGN}", "-")) for text in numbers(axis)]
    np.testing.assert_allclose(read, places, rtol=1e-12, atol=1e-9 * np.diff(places)[0])
    assert axis.get_offset_text().get_text() == ""
    for row, column in [(1, 1), (2, 1), (3, 2)]:
        assert numbers(axes[row, column].xaxis) == numbers(axes[row, column].yaxis) == []
    # Lines aslant by 45° are apart by less than their places; a line is 1.2 times as high as its letters.
    assert_apart([label for ax in axes[4] for label in ax.get_xticklabels()], 0, 1.2 * np.sqrt(2))
    for row in range(1, 5):
        assert_apart(axes[row, 0].get_yticklabels(), 1, 1.2)


def assert_apart(labels: list[Any], along: int, lines: float) -> None:
    """The places of texts differ by as many heights of letters, and the texts are within the figure."""
    figure = labels[0].figure
    places = [label.get_transform().transform(label.get_position())[along] for label in labels]
    assert np.diff(places).min() > lines * labels[0].get_fontsize() * figure.dpi / 72
    for label in labels:
        box = label.get_window_extent()
        assert box.min.min() >= 0
        assert (box.max <= figure.bbox.max).all()


def test_wrong_input_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^draws: expected 4 draws or more of each chain, got 3"):
        FIT.sample(draws=3)
    with pytest.raises(ValueError, match=r"^chains: expected 1 chain or more, got 0"):
        FIT.sample(chains=0)
    planned = asp.fit(TRUE, POSITION, None, free=NAMES, noise="white", reading=5.0)
    refused: list[Callable[[], object]] = [
        planned.sample,
        planned.free_form,
        lambda: planned.profile("count"),
        lambda: planned.interval_by_profile("count"),
        lambda: planned.log_likelihood([1.0, 0.2, 1000.0]),
    ]
    for call in refused:
        with pytest.raises(ValueError, match=r"^force: expected measured forces: .* only planned"):
            call()


def test_progress_rises_to_one() -> None:
    reported: list[float] = []
    FIT.sample(draws=20, chains=2, progress=reported.append)
    assert reported[-1] == 1.0
    assert reported == sorted(reported)

"""Descriptions are values: compared, printed, copied with changes, sent to other processes."""

import math
import pickle
from typing import Any

import asperity as asp
import pytest
from families import PARAMETRIC, member

LAWS: list[asp.Law] = [
    *(member(kind, 0.1 + 0.2, 4.0 / 3.0) for kind in PARAMETRIC),
    asp.Gaussian(1.0, 0.05),
    asp.Weibull(12.0, 1e-7),
    asp.Tabulated(stretch=[0.0, 0.1, 1.0], density=[0.0, 3.0, 1.0]),
    asp.Tabulated(samples=[0.9, 1.1, 1.0]),
    asp.Series([0.0, 1.0, 3.0], [[0.5], [0.25, -0.25]]),
    asp.Series([0.0, 1.0], [[1.0]], cut=1e-40),
    asp.Mixture([(0.25, asp.Point(1.0)), (0.75, asp.Gaussian(2.0, 0.5))]),
    asp.Renormalised(asp.Gaussian(1.0, 0.1), 0.2),
    asp.Renormalised(asp.Renormalised(asp.Rectangular(0.5, 1.5), 0.1), coupling=0.1),
]
AREAS = asp.Areas(asp.Gamma(1.0, 0.5), modulus=2.0, strength=3.0)
CONTACTS = [
    asp.Contacts(asp.Gaussian(1.0, 0.05)),
    asp.Contacts(
        asp.Gaussian(1.0, 0.05), asp.Rectangular(0.0, 0.1), count=100, stiffness=2.0, normal_load=5.0
    ),
    asp.Contacts(asp.Gamma(1.0, 0.2), stiffness_per_threshold=2.0),
    asp.Contacts(asp.Gamma(1.0, 0.2), stiffness_of_threshold=([0.5, 1.5], [1.0, 3.0])),
    asp.Contacts(areas=AREAS),
    asp.Contacts(asp.Gamma(1.0, 0.2), background_force=2.0),
    asp.Contacts(asp.Gamma(1.0, 0.2), normal_load=5.0, background_coefficient=0.5),
]
MODELS = [
    asp.MasterEquation(CONTACTS[0]),
    asp.MasterEquation(CONTACTS[1], asp.Gaussian(0.1, 0.025), start="relaxed", tolerance=1e-8),
    asp.Ensemble(CONTACTS[0], size=10),
    asp.Ensemble(CONTACTS[0], asp.Point(0.1), size=10, seed=2**63 - 1, disorder="quenched", start="relaxed"),
]
SLIDERS = [
    asp.Damped(0.5),
    asp.Inertial(2.0),
    asp.Inertial(2.0, damping=0.5),
    asp.Block(MODELS[0], 1.0),
    asp.Block(MODELS[0], 1.0, "overdamped", slip_fraction=0.1),
    asp.Block(MODELS[1], 0.1 + 0.2, asp.Inertial(2.0, 0.5)),
    asp.Block(MODELS[0], 1.0, asp.Damped(0.5)),
    asp.Block(MODELS[2], None),
    asp.Block(MODELS[3], 1e-7, "arrest"),
]
ALL = [*LAWS, AREAS, *CONTACTS, *MODELS, *SLIDERS]

every_one = pytest.mark.parametrize("description", ALL, ids=lambda one: type(one).__name__)


@every_one
def test_pickles_are_equal(description: asp.Description) -> None:
    copy = pickle.loads(pickle.dumps(description))
    assert copy == description
    assert type(copy) is type(description)
    assert hash(copy) == hash(description)


@every_one
def test_what_is_printed_makes_it_anew(description: asp.Description) -> None:
    assert eval(repr(description), vars(asp)) == description


@every_one
def test_parameters_make_it_anew(description: asp.Description) -> None:
    kind: Any = type(description)
    assert kind(**description.parameters) == description
    assert description.replace() == description


@every_one
def test_notebooks_show_every_parameter(description: asp.Description) -> None:
    html = description._repr_html_()
    assert html.startswith("<table>")
    assert all(f">{name}<" in html for name in description.parameters)


@pytest.mark.parametrize("law", LAWS, ids=lambda one: type(one).__name__)
def test_parameters_of_distributions_are_attributes(law: asp.Law) -> None:
    for name, value in law.parameters.items():
        attribute = getattr(law, name)
        # The distribution itself has a mean and a standard deviation, as in scipy.stats.
        assert callable(attribute) if name in ("mean", "std") else attribute == value
    assert callable(law.mean)
    assert callable(law.std)


def test_parameters_that_were_not_given_have_their_defaults() -> None:
    table = asp.Tabulated(stretch=[0.0, 1.0], density=[2.0, 2.0])
    assert (table.stretch, table.density, table.samples) == ([0.0, 1.0], [2.0, 2.0], None)
    assert (table.bandwidth, table.exact) == (None, False)
    assert asp.Tabulated(samples=[1.0, 2.0], bandwidth=0.5).bandwidth == 0.5
    assert asp.Tabulated(samples=[1.0, 2.0], exact=True).exact
    assert asp.Series([0.0, 1.0], [[1.0]]).cut == 0.0


def test_different_descriptions_differ() -> None:
    assert len(set(ALL)) == len(ALL)
    assert asp.Gaussian(1.0, 0.05) != asp.Gamma(1.0, 0.05)
    assert asp.Point(1.0) != 1.0


def test_replaced_values_are_checked() -> None:
    theory = asp.MasterEquation(CONTACTS[0])
    loose = theory.replace(tolerance=1e-6)
    assert (loose.tolerance, loose.contacts, theory.tolerance) == (1e-6, theory.contacts, None)
    with pytest.raises(ValueError, match=r"master_equation\.tolerance: expected .* got 1e0"):
        theory.replace(tolerance=1.0)
    with pytest.raises(TypeError, match="unexpected keyword argument 'stiffness'"):
        theory.replace(stiffness=1.0)


def test_sliders_are_replaced_in_part() -> None:
    block = asp.Block(MODELS[0], 1.0, "overdamped")
    rigid = block.replace(stiffness=math.inf)
    assert (rigid.model, rigid.slip, rigid.stiffness) == (block.model, "overdamped", math.inf)
    assert rigid == block.replace(stiffness=None)
    assert rigid.replace(stiffness=1.0) == block
    assert asp.Block(MODELS[0], 1.0, asp.Inertial(2.0)).slip == asp.Inertial(2.0, 0.0)


def test_descriptions_cannot_be_changed() -> None:
    contacts: Any = CONTACTS[0]
    with pytest.raises(AttributeError):
        contacts.count = 2.0


def test_pickles_of_another_version_are_refused() -> None:
    restore, (version, text) = asp.Point(1.0).__reduce__()
    assert version == asp.__version__
    with pytest.raises(ValueError, match=f"written by asperity {version}, got one of asperity 0.0.9"):
        restore("0.0.9", text)
    with pytest.raises(ValueError, match="expected a description"):
        restore(version, "{}")
    with pytest.raises(ValueError, match=r"point.at: expected .* got -1"):
        restore(version, text.replace("1.0", "-1.0"))


def test_long_lists_are_cut_short_in_print() -> None:
    law = asp.Tabulated(samples=[i / 1e6 for i in range(1001)])
    assert repr(law) == "Tabulated(samples=[0.0, 1e-06, 2e-06, ..., 0.000998, 0.000999, 0.001])"
    assert "1001 items" in law._repr_html_()

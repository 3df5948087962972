"""Sufficient statistics: made, written down, merged, solved."""

import pickle

import numpy as np
import pytest

import dynid
from conftest import recorded


def test_factors_that_are_sent_and_merged_have_the_parameters_of_all_recordings(planar):
    parts = [recorded(planar, seed=s, duration=10)[0] for s in (1, 2)]
    first, second = (dynid.factor(rec, band=20) for rec in parts)
    sent = dynid.Factors.from_bytes(bytes(second), planar)
    fit = dynid.solve(dynid.merge([first, sent]))
    together = dynid.identify(parts, band=20)
    np.testing.assert_allclose(fit.values, together.values, rtol=0, atol=0.2 * together.sigma.min())
    assert np.abs((fit.values - planar.chi) / fit.sigma).max() < 5
    assert len(dynid.merge([first, sent]).motions) == 2


def test_bytes_are_read_back_exactly(tx40):
    factors = dynid.factor(recorded(tx40, duration=10)[0], band=20)
    for again in [dynid.Factors.from_bytes(bytes(factors), tx40), pickle.loads(pickle.dumps(factors))]:
        assert bytes(again) == bytes(factors) and again.rows == factors.rows
        assert dynid.solve(again).json() == dynid.solve(factors).json()


def test_bytes_that_are_no_factors_of_the_robot_are_refused(planar, tx40):
    factors = dynid.factor(recorded(planar, duration=10)[0])
    data = bytes(factors)
    with pytest.raises(dynid.Error, match="factors of another robot than tx40"):
        dynid.Factors.from_bytes(data, tx40)
    for wrong in [b"", data[:-10], data.replace(b'"equation":1', b'"equation":7'), data.replace(b'"columns":[', b'"columns":[99,')]:
        with pytest.raises(dynid.Error, match="factors"):
            dynid.Factors.from_bytes(wrong, planar)
    with pytest.raises(dynid.Error, match="different robots"):
        dynid.merge([factors, dynid.factor(recorded(tx40, duration=10)[0])])
    with pytest.raises(dynid.Error, match="there are no factors"):
        dynid.merge([])
    with pytest.raises(dynid.Error, match="needs the recording"):
        dynid.solve(factors, method="pim-wls")

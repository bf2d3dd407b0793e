"""Proofs of the resolvent and the noise of a passive network."""

from derivation import networks


def test_response_is_the_inverse_impedance():
    assert networks.resolvent() == 0


def test_noise_balances_dissipation():
    assert not any(networks.noise())

"""Coverage of the intervals of `tweezer.fit_chain`: `python -m tests.chain_coverage [CURVES]`.

A trap of 100 pN/um stretches a polymer of 1000 nm. The deflection of the bead has white noise,
which changes force and extension together.
"""

import sys

import numpy as np

import tweezer
from tweezer.forces.chains import chain

T = 298.0
TRAP = 1e-4
POLYMER = {"contour_length": 1e-6, "persistence_length": 50e-9}
TWIST = {
    "twist_rigidity": 440e-30, "twist_coupling": -637e-21, "twist_coupling_slope": 17e-9,
    "critical_force": 30.6e-12,
}  # fmt: skip
WEAK, STRONG = np.geomspace(0.1e-12, 15e-12, 40), np.geomspace(0.5e-12, 60e-12, 60)
#: model, stretch modulus, forces, standard deviation of the deflection, further parameters
CASES = {
    "marko-siggia": ("marko-siggia", None, WEAK, 0.5e-9, {}),
    "bouchiat": ("bouchiat", None, WEAK, 0.5e-9, {}),
    "bouchiat, 2 nm": ("bouchiat", None, WEAK, 2e-9, {}),
    "bouchiat, stretching": ("bouchiat", 1e-9, STRONG, 0.5e-9, {}),
    "odijk": ("odijk", 1e-9, 2 * STRONG, 0.5e-9, {}),
    "fjc": ("fjc", None, WEAK, 0.5e-9, {}),
    "efjc": ("efjc", 1e-9, STRONG, 0.5e-9, {}),
    "twlc": ("twlc", 1.5e-9, np.geomspace(1e-12, 60e-12, 60), 0.5e-9, TWIST),
}


def fits(case, curves, seed=0):
    """Yield the fit of each curve."""
    model, modulus, force, noise, more = CASES[case]
    extra = more if modulus is None else more | {"stretch_modulus": modulus}
    extension = chain(model, **POLYMER, temperature=T, **extra).extension(force)[0]
    rng = np.random.default_rng(seed)
    fitted = more if modulus is None else more | {"stretch_modulus": "fit"}
    for _ in range(curves):
        error = noise * rng.normal(size=force.size)
        yield tweezer.fit_chain(
            extension - error, force + TRAP * error, model=model, temperature=T,
            extension_error=noise, force_error=TRAP * noise, **fitted,
        )  # fmt: skip


def contained(case, fit):
    """Whether the interval of each fitted parameter contains the true value."""
    truth = POLYMER | {"stretch_modulus": CASES[case][1]}
    intervals = [(each, getattr(fit, f"{name}_interval")) for name, each in truth.items() if each]
    return [low <= each <= high for each, (low, high) in intervals]


def coverage(case, curves, seed=0):
    """Fraction of curves whose intervals contain the true values, and with findings."""
    found = list(fits(case, curves, seed))
    return (
        np.mean([contained(case, each) for each in found], axis=0),
        np.mean([bool(each.findings) for each in found]),
    )


if __name__ == "__main__":
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    for name in CASES:
        within, findings = coverage(name, number)
        print(f"{name:22} {' '.join(f'{each:.1%}' for each in within):22} findings {findings:.1%}")

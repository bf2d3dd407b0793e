"""What a calibration found, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from tweezer.calibration.free import INFERRED, Diffusion
from tweezer.calibration.results import AxisCalibration
from tweezer.values.rounding import rounded, with_uncertainty

#: Parameters of a detector in words, with the factor to their unit and the unit.
_DETECTOR = {
    "exposure": ("blur", 1e6, "us"),
    "diode_frequency": ("diode", 1e-3, "kHz"),
    "diode_fraction": ("detected at once", 1.0, ""),
}


def axis_in_words(axis: AxisCalibration, unit: str, notes: Sequence[str]) -> list[str]:
    """Return the lines on an axis beside its stiffness, beginning with the spectrum.

    `unit` is the unit of the recording; `notes` are its findings, in the order of their numbers.
    """
    against = _not_trusted(axis, notes)
    remarks = (finding.text for finding in axis.remarks)
    return [_spectrum(axis, against), *_detector_and_drive(axis, unit, against), *remarks]


def _spectrum(axis: AxisCalibration, against: Sequence[str]) -> str:
    """Corner frequency, diffusion if it was fitted, and how well the fit describes the spectrum."""
    fit, free = axis.fit, axis.free_fit
    corner = _determined(fit.bead.corner_frequency, fit.corner_frequency_uncertainty, 1.0, "Hz")
    parts = [f"corner frequency {corner}"]
    if free.drag_uncertainty is not None:
        diffusion = _determined(free.bead.diffusion, axis.diffusion_uncertainty, 1e12, "um^2/s")
        parts.append(f"diffusion {diffusion}")
    return "; ".join((*parts, f"p = {free.p_value:.2g}", *against))


def _not_trusted(axis: AxisCalibration, notes: Sequence[str]) -> list[str]:
    """Return the line with the findings against the recording, which apply to all its results."""
    numbers = [str(notes.index(each.text) + 1) for each in axis.findings if each.text in notes]
    return [f"not trusted: {', '.join(numbers)}"] if numbers else []


def _detector_and_drive(axis: AxisCalibration, unit: str, against: Sequence[str]) -> Iterator[str]:
    """Lines on what the record tells of the detector, and of the drive."""
    volt, nano = (1e3, "mV") if unit == "V" else (1e9, "nm")
    words = {**_DETECTOR, "noise": ("noise", volt, nano)}
    told = [
        f"{words[each.name][0]} {_scaled(each.value, each.uncertainty, *words[each.name][1:])}"
        for each in axis.detector
        if each.value is not None
    ]
    if told:
        yield "; ".join((*told, *against))
    if axis.sensitivity is not None:
        drag = axis.free_fit
        metres = axis.sensitivity, axis.sensitivity_uncertainty
        force = axis.force_sensitivity, axis.force_sensitivity_uncertainty
        parts = [f"recorded metres are {_scaled(*metres, 1.0, 'm')}"]
        if unit == "V":
            parts = [_scaled(*metres, 1e6, "um/V"), _scaled(*force, 1e12, "pN/V")]
        parts.append(f"drag {_scaled(drag.bead.drag, drag.drag_uncertainty, 1e9, 'nN s/m')}")
        yield "; ".join((*parts, *against))
    for each in axis.answers:
        answer = _scaled(each.signal, each.signal_uncertainty, volt, nano)
        yield f"stage {each.frequency:.5g} Hz, {1e9 * each.stage:.4g} nm: {answer}"


def _determined(value: float, uncertainty: float, factor: float, unit: str) -> str:
    if not 0 < uncertainty < value:
        return "not determined"
    return _scaled(value, uncertainty, factor, unit)


def _scaled(value: float | None, uncertainty: float | None, factor: float, unit: str) -> str:
    error = math.nan if uncertainty is None else factor * uncertainty
    return f"{with_uncertainty(factor * (value or math.nan), error)} {unit}".rstrip()


#: Verdict on a bead that was tested for a trap
NO_TRAP = "no trap is detected; treated as a free bead"


def diffusion_in_words(free: Diffusion, unit: str, seen: str = NO_TRAP) -> str:
    """Return the diffusion of free beads in one line.

    Parameters
    ----------
    free : Diffusion
    unit : str
        Of the recording, "m" or "V".
    seen : str
        What the line says of the bead before its diffusion.
    """
    axes = ", ".join(each.axis for each in free.axes)
    relative = free.uncertainty / free.diffusion
    factor, of = (1e12, "um^2/s") if unit == "m" else (1.0, "V^2/s")
    told = _with_interval(free.diffusion, relative, free.interval, factor, of)
    parts = [f"{axes}: {seen}: diffusion {told}"]
    inferred = free.inferred
    if inferred is not None and free.interval[0]:
        name, factor, of = INFERRED[inferred.name]
        told = _with_interval(inferred.value, relative, inferred.interval, factor, of)
        parts.append(f"{name} {told}")
    if free.expected is not None:
        parts.append(f"by Einstein the diffusion is {1e12 * free.expected:.4g} um^2/s")
    return "; ".join(parts)


def _with_interval(
    value: float, relative: float, ends: tuple[float, float], factor: float, unit: str
) -> str:
    """Value, standard uncertainty and 95 % interval, with as many digits as these leave."""
    low, high = (factor * end for end in ends)
    if not low or not math.isfinite(high):
        return f"below {high:.2g} {unit} (95 %)"
    error = factor * value * relative
    first, last = rounded(low, error)[0], rounded(high, error)[0]
    return f"{with_uncertainty(factor * value, error)} {unit} (95 %: {first} to {last})"

"""What a calibration found, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from tweezer.calibration.free import INFERRED, Diffusion
from tweezer.calibration.results import AxisCalibration
from tweezer.values.printed import pair, printed, signal_unit, with_error

#: Parameters of a detector in words, with their unit.
_DETECTOR = {
    "exposure": ("blur", "us"),
    "diode_frequency": ("diode", "kHz"),
    "diode_fraction": ("detected at once", ""),
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
    corner = _determined(fit.bead.corner_frequency, fit.corner_frequency_uncertainty, "Hz")
    parts = [f"corner frequency {corner}"]
    if free.drag_uncertainty is not None:
        diffusion = _determined(free.bead.diffusion, axis.diffusion_uncertainty, "um^2/s")
        parts.append(f"diffusion {diffusion}")
    return "; ".join((*parts, f"p = {free.p_value:.2g}", *against))


def _not_trusted(axis: AxisCalibration, notes: Sequence[str]) -> list[str]:
    """Return the line with the findings against the recording, which apply to all its results."""
    numbers = [str(notes.index(each.text) + 1) for each in axis.findings if each.text in notes]
    return [f"not trusted: {', '.join(numbers)}"] if numbers else []


def _detector_and_drive(axis: AxisCalibration, unit: str, against: Sequence[str]) -> Iterator[str]:
    """Lines on what the record tells of the detector, and of the drive."""
    of = signal_unit(unit)
    words = {**_DETECTOR, "noise": ("noise", of)}
    told = [
        f"{words[each.name][0]} {with_error(each.value, each.uncertainty, words[each.name][1])}"
        for each in axis.detector
        if each.value is not None
    ]
    if told:
        yield "; ".join((*told, *against))
    if axis.sensitivity is not None:
        drag = axis.free_fit
        metres = axis.sensitivity, axis.sensitivity_uncertainty
        parts = [f"recorded metres are {with_error(*metres, 'm')}"]
        if unit == "V" and axis.force_sensitivity is not None:
            force = axis.force_sensitivity, axis.force_sensitivity_uncertainty
            parts = [with_error(*metres, "um/V"), with_error(*force, "pN/V")]
        parts.append(f"drag {with_error(drag.bead.drag, drag.drag_uncertainty, 'nN s/m')}")
        yield "; ".join((*parts, *against))
    for each in axis.answers:
        answer = with_error(each.signal, each.signal_uncertainty, of)
        yield f"stage {each.frequency:.5g} Hz, {printed(each.stage, 'nm')}: {answer}"


def _determined(value: float, uncertainty: float, unit: str) -> str:
    return with_error(value, uncertainty, unit) if 0 < uncertainty < value else "not determined"


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
    of = "um^2/s" if unit == "m" else "V^2/s"
    told = _with_interval(free.diffusion, relative, free.interval, of)
    parts = [f"{axes}: {seen}: diffusion {told}"]
    inferred = free.inferred
    if inferred is not None and free.interval[0]:
        name, of = INFERRED[inferred.name]
        told = _with_interval(inferred.value, relative, inferred.interval, of)
        parts.append(f"{name} {told}")
    if free.expected is not None:
        parts.append(f"by Einstein the diffusion is {printed(free.expected, 'um^2/s')}")
    return "; ".join(parts)


def _with_interval(value: float, relative: float, ends: tuple[float, float], unit: str) -> str:
    """Value, standard uncertainty and 95 % interval, with as many digits as these leave."""
    low, high = ends
    if not low or not math.isfinite(high):
        return f"below {printed(high, unit, 2)} (95 %)"
    error = value * relative
    first, last = (pair(end, error, unit)[0] for end in ends)
    return f"{with_error(value, error, unit)} (95 %: {first} to {last})"

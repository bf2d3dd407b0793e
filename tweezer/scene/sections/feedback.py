"""The section of a scene for a controller that acts on the bead by what it measures."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from tweezer.scene.courses import Section, refusal
from tweezer.values.units import Frequency, Length, Quantity

#: A number of a controller, in SI units
Number = Annotated[float, Quantity("", -1e60, 1e60)]
#: What each kind of controller acts on, if a scene does not state it
_DRIVES = {
    "cold": "force", "parametric": "beam.power", "clamp": "beam.position", "pid": "force",
    "matrices": "force",
}  # fmt: skip
#: Keys that each kind requires
_REQUIRES = {
    "cold": ("gain",), "parametric": ("gain",), "clamp": ("gain",), "pid": ("gains",),
    "matrices": ("F", "G", "H", "J"),
}  # fmt: skip
#: Largest number of ticks of a delay, and of numbers that a controller keeps for an axis
_MOST_TICKS, _MOST_STATES = 1000, 50


class Feedback(Section):
    """A controller: it measures positions at even times and acts on the bead or on the light."""

    kind: Literal["cold", "parametric", "clamp", "pid", "matrices"] = Field(
        description="cold: damping, the force -m gain dy/dt; parametric: the power changes by the "
        "part gain y dy/dt; clamp: the focus follows the bead, dX/dt = gain (y - X); pid: "
        "-(P y + I int y dt + D dy/dt); matrices: c' = F c + G y, output H c + J y"
    )
    measures: tuple[Literal["x", "y", "z"], ...] = Field(
        ("x",), description="axes that are measured, and along which the controller acts"
    )
    rate: Frequency = Field(description="number of measurements (ticks) per second")
    delay: Annotated[float, Quantity("s", 0, 1e3)] = Field(
        0.0, description="time from a measurement to the action; a whole number of ticks"
    )
    noise: Annotated[float, Quantity("m^2/Hz", 0, 1e-6)] = Field(
        0.0, description="two-sided spectral density of the noise of a measured position"
    )
    target: Length = Field(0.0, description="position that is subtracted from the measured ones")
    gain: Number | None = Field(
        None,
        description="cold, clamp: rate, 1/s; parametric: relative change of the power over y dy/dt,"
        " s/m^2",
    )
    gains: tuple[Number, Number, Number] | None = Field(
        None, description="pid: P, I, D in output per m, per m s, and per m/s"
    )
    F: tuple[tuple[Number, ...], ...] | None = Field(
        None, description="matrices: the state of the controller after a tick from the one before"
    )
    G: tuple[Number, ...] | None = Field(None, description="matrices: its change by a position")
    H: tuple[Number, ...] | None = Field(None, description="matrices: the output by the state")
    J: Number | None = Field(None, description="matrices: the output by the position, 1/m or N/m")
    drives: Literal["force", "beam.power", "beam.position"] | None = Field(
        None,
        description="force: the output is a force, N; beam.power: a relative change of the power; "
        "beam.position: a displacement of the focus, m. Default: force for cold, pid and matrices; "
        "beam.power for parametric; beam.position for clamp",
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        """Refuse missing and superfluous gains, matrices of other shapes and long delays."""
        required = _REQUIRES[self.kind]
        for key in ("gain", "gains", "F", "G", "H", "J"):
            given = getattr(self, key) is not None
            if given != (key in required):
                problem = "is missing" if key in required else "does not apply"
                raise refusal(f"{key}: {problem}; kind = {self.kind!r} takes {', '.join(required)}")
        if len(set(self.measures)) != len(self.measures) or not self.measures:
            raise refusal(f"measures = {list(self.measures)}: must name one to three axes once")
        if self.kind not in ("pid", "matrices"):
            own = _DRIVES[self.kind]
            if self.drives not in (None, own):
                raise refusal(f"drives = {self.drives!r}: must be {own!r} for {self.kind!r}")
        ticks = self.delay * self.rate
        if abs(ticks - round(ticks)) > 1e-6 * max(1.0, ticks) or ticks > _MOST_TICKS:
            raise refusal(
                f"delay = {self.delay:g}: is {ticks:.6g} ticks of 1/rate; must be a whole number "
                f"up to {_MOST_TICKS}"
            )
        if self.F is not None:
            n = len(self.F)
            square = all(len(row) == n for row in self.F)
            if not square or len(self.G or ()) != n or len(self.H or ()) != n or n > _MOST_STATES:
                raise refusal(
                    f"F, G, H: must be n x n, n and n numbers, with n at most {_MOST_STATES}"
                )
        return self

    @property
    def acts_on(self) -> str:
        """The output: "force", "beam.power" or "beam.position"."""
        return self.drives or _DRIVES[self.kind]

    @property
    def output(self) -> str:
        """Name of the output in a run."""
        return f"feedback_{self.acts_on.removeprefix('beam.')}"

    @property
    def ticks_late(self) -> int:
        """Number of ticks from a measurement to the action."""
        return round(self.delay * self.rate)

"""Section of a bead whose mass, inertia and drag are given."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Field, field_validator, model_validator

from tweezer.scene.courses import Section, Vector, refusal
from tweezer.values.units import Quantity, Temperature, Viscosity, entries, listed

Mass = Annotated[float, Quantity("kg", 1e-30, 1.0)]
Volume = Annotated[float, Quantity("m^3", 1e-30, 1e-3)]
_Product = Annotated[float, Quantity("kg m^2", -1e-3, 1e-3)]
_Row3 = Annotated[tuple[_Product, _Product, _Product], entries(3)]
Inertia = Annotated[tuple[_Row3, _Row3, _Row3], entries(3)]
_Number = Annotated[float, Quantity("", -1e30, 1e30)]
_Row6 = Annotated[tuple[_Number, ...], entries(6)]
Matrix = Annotated[tuple[_Row6, ...], entries(6)]

#: Largest difference of opposite elements, over the roots of the elements of the diagonal
_SYMMETRIC = 1e-6


class Given(Section):
    """Mass, inertia and drag of a body, in the body's frame."""

    mass: Mass = Field(description="mass")
    volume: Volume = Field(description="volume of the displaced fluid")
    inertia: Inertia = Field(
        description="inertia tensor about the centre of mass, or its three principal moments "
        "along x, y and z"
    )
    centre_of_volume: Vector = Field(
        (0.0, 0.0, 0.0), description="point at which buoyancy acts, from the centre of mass"
    )
    resistance: Matrix | None = Field(
        None,
        description="resistance matrix, 6 x 6 in kg/s, kg m/s and kg m^2/s: translation first",
    )
    diffusion: Matrix | None = Field(
        None,
        description="diffusion matrix, 6 x 6 in cm^2/s, cm/s and 1/s as programs of the HYDRO "
        "family print it, instead of the resistance; requires `temperature` and `viscosity`",
    )
    point: Vector = Field(
        (0.0, 0.0, 0.0),
        description="point of reference of the matrix, such as the centre of diffusion, from the "
        "centre of mass",
    )
    temperature: Temperature | None = Field(None, description="temperature of the diffusion")
    viscosity: Viscosity | None = Field(
        None,
        description="viscosity for which the matrix holds; the drag is scaled from it to the "
        "medium's. Default for a resistance: as of the medium",
    )

    @field_validator("inertia", mode="before")
    @classmethod
    def _principal(cls, value: Any) -> Any:
        """Return three principal moments as the rows of a tensor."""
        rows = listed(value)
        if isinstance(rows, list | tuple) and not any(
            isinstance(row, list | tuple) for row in rows
        ):
            return [[each if i == j else 0.0 for j in range(len(rows))]
                    for i, each in enumerate(rows)]  # fmt: skip
        return value

    @model_validator(mode="after")
    def _possible(self) -> Self:
        """Refuse matrices that no body can have, and missing keys."""
        import numpy as np

        if (self.resistance is None) == (self.diffusion is None):
            both = "one is required" if self.resistance is None else "give only one"
            raise refusal(f"resistance or diffusion: {both}")
        for key in ("temperature", "viscosity"):
            if self.diffusion is not None and getattr(self, key) is None:
                raise refusal(f"{key}: missing; diffusion requires it")
        if self.resistance is not None and self.temperature is not None:
            raise refusal("temperature: does not apply to resistance; remove it")
        for key in ("inertia", "resistance", "diffusion"):
            if getattr(self, key) is not None:
                _check_positive(key, np.array(getattr(self, key)))
        moments = np.linalg.eigvalsh(np.array(self.inertia))
        if moments[2] > (moments[0] + moments[1]) * (1 + 1e-9):
            raise refusal(
                f"inertia: the principal moments {', '.join(f'{each:.4g}' for each in moments)} "
                "are of no body, because one is larger than the sum of the other two"
            )
        return self


def _check_positive(key: str, matrix: Any) -> None:
    """Refuse a matrix that is not symmetric and positive, in units of its diagonal."""
    import numpy as np

    diagonal = np.diag(matrix)
    if not (diagonal > 0).all():
        raise refusal(f"{key}: has {diagonal.min():.4g} on its diagonal; must be positive")
    scaled = matrix / np.sqrt(np.outer(diagonal, diagonal))
    if (apart := np.abs(scaled - scaled.T).max()) > _SYMMETRIC:
        raise refusal(
            f"{key}: opposite elements differ by {apart:.2g} of the diagonal; must be symmetric to "
            f"{_SYMMETRIC:g}"
        )
    if not (lowest := np.linalg.eigvalsh(scaled)[0]) > 0:
        raise refusal(
            f"{key}: has the eigenvalue {lowest:.2g} in units of its diagonal; must be positive"
        )

"""The tables of docs/materials.md, from the catalogues: `python -m tests.catalogue_page`."""

from __future__ import annotations

import re
from pathlib import Path

from tweezer.scene.catalogue import LASERS, OBJECTIVES
from tweezer.scene.materials import Material, materials

PAGE = Path(__file__).parents[1] / "docs" / "materials.md"
#: Wavelengths of the table, nm
SHOWN = (532, 633, 1064)
FORMULAS = {
    "sellmeier": "Sellmeier's formula: ",
    "powers": "Powers of the wavelength: ",
    "value": "One value",
    "table": "Table",
}


def written() -> dict[str, str]:
    """Each block of the page by its name, markers and all."""
    tables = {
        "materials": [*_of_indices(), "", *_of_sources()],
        "objectives": _of_objectives(),
        "lasers": _of_lasers(),
    }
    return {
        name: "\n".join([f"<!-- {name} -->", "", *lines, "", "<!-- end -->"])
        for name, lines in tables.items()
    }


def between(name: str) -> re.Pattern[str]:
    """A block of the page, markers and all."""
    return re.compile(rf"<!-- {name} -->\n.*?<!-- end -->", re.DOTALL)


def _of_indices() -> list[str]:
    heads = " | ".join(f"{nm} nm" for nm in SHOWN)
    rows = [
        f"| `material` | {heads} | from, to (µm) | others differ by | density (kg/m³) |",
        "| --- " * (len(SHOWN) + 4) + "|",
    ]
    for each in materials().values():
        low, high = each.used
        indices = " | ".join(_index(each, nm) for nm in SHOWN)
        rows.append(
            f"| `{each.name}` | {indices} | {low:g}, {high:g} | {each.error:g} | {each.density:g} |"
        )
    return rows


def _index(material: Material, nm: float) -> str:
    try:
        index = material.refractive_index(1e-9 * nm)
    except ValueError:
        return ""
    return f"{index.real:.4f}" if index.imag == 0 else f"{index.real:.2f}+{index.imag:.3g}j"


def _of_sources() -> list[str]:
    lines = []
    for each in materials().values():
        low, high = each.measured
        span = f"Measured from {low:g} to {high:g} µm" if high > low else f"Measured at {low:g} µm"
        lines.append(
            f"- **{each.name}**: {each.source}. {span}. {FORMULAS[each.formula]}{_terms(each)}. "
            f"{each.note} Density: {each.density_source}."
        )
    return lines


def _terms(material: Material) -> str:
    if material.formula == "sellmeier":
        return ", ".join(f"B = {b:.9g}, C = {c:.9g} µm²" for b, c in material.numbers)
    if material.formula == "powers":
        return ", ".join(f"{c:g} at p = {power:g}" for c, power in material.numbers)
    return f" of {len(material.numbers)} rows" if material.formula == "table" else ""


def _of_objectives() -> list[str]:
    rows = [
        "| `--objective` | NA | f (mm) | radius of the pupil (mm) | example |",
        "| --- | --- | --- | --- | --- |",
    ]
    for each in OBJECTIVES.values():
        f, radius = 1e3 * each.focal_length, 1e3 * each.pupil_radius
        rows.append(
            f"| `{each.name}` | {each.numerical_aperture:.2f} | {f:.3g} | {radius:.3g} | "
            f"{each.example} |"
        )
    return rows


def _of_lasers() -> list[str]:
    rows = ["| `--laser` | type | default power |", "| --- | --- | --- |"]
    return rows + [f"| `{each.name}` | {each.kind} | {each.power} |" for each in LASERS.values()]


if __name__ == "__main__":
    text = PAGE.read_text(encoding="utf-8")
    for name, block in written().items():
        text = between(name).sub(lambda _, block=block: block, text)
    PAGE.write_text(text, encoding="utf-8")

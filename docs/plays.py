"""Follow scenes, and write each as a page that plays: `python docs/plays.py FOLDER NAME ...`."""

import sys
import warnings
from pathlib import Path

import tweezer


def main(folder: Path, names: list[str]) -> None:
    """Write the pages into `folder`, and say which one is made."""
    folder.mkdir(parents=True, exist_ok=True)
    warnings.simplefilter("ignore", tweezer.PhysicsWarning)  # the pages say it
    for name in names:
        sys.stderr.write(f"a page that plays: {name}\n")
        tweezer.view(name).save(folder / f"{name}.html")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])

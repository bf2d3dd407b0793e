"""Make the one file of three.js that pages hold: `make vendor`. It needs npm and the network.

The package is fetched at a pinned version, and what the pages use of it is bundled by esbuild. The
same versions give the same bytes. `README.md` beside the file names version, licence and digest.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

VENDOR = Path(__file__).parents[1] / "tweezer" / "viewing" / "static" / "vendor"
BUNDLE = VENDOR / "three.module.min.js"
THREE, ESBUILD = "0.180.0", "0.28.2"

#: what the modules of a page import
ENTRY = """
export {
  BufferAttribute, BufferGeometry, Color, ConeGeometry, CylinderGeometry, DataTexture, DoubleSide,
  FrontSide, Group, LinearFilter, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial,
  PerspectiveCamera, PlaneGeometry, Points, PointsMaterial, Quaternion, RGBAFormat, Scene,
  ShaderMaterial, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
"""

README = """# three.js

`three.module.min.js` holds what the pages of tweezer use of three.js {version}
(https://threejs.org, package `three` of npm), in one file. `LICENSE` is its licence, MIT.
`make vendor` makes the file again: `tests/vendored.py` names what is taken.

| | |
| --- | --- |
| package | three {version} |
| bundled by | esbuild {esbuild} |
| licence | MIT |
| SHA-256 | {digest} |
"""


def main() -> None:
    """Fetch, bundle and write, with the licence and a note of what was taken."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        fetched = ["npm", "install", "--ignore-scripts", "--no-audit", "--no-fund", "--prefix", "."]
        packages = f"three@{THREE}", f"esbuild@{ESBUILD}"
        subprocess.run([*fetched, *packages], cwd=folder, check=True)
        (folder / "entry.js").write_text(ENTRY)
        bundler = folder / "node_modules" / ".bin" / "esbuild"
        options = ["--bundle", "--format=esm", "--minify", "--legal-comments=inline"]
        subprocess.run(
            [bundler, "entry.js", *options, "--outfile=bundle.js"],
            cwd=folder, check=True, env={**os.environ, "NODE_ENV": "production"},
        )  # fmt: skip
        shutil.copyfile(folder / "bundle.js", BUNDLE)
        shutil.copyfile(folder / "node_modules" / "three" / "LICENSE", VENDOR / "LICENSE")
    digest = hashlib.sha256(BUNDLE.read_bytes()).hexdigest()
    said = README.format(version=THREE, esbuild=ESBUILD, digest=digest)
    (VENDOR / "README.md").write_text(said)


if __name__ == "__main__":
    main()

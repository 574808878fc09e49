#!/usr/bin/env python3
"""Draws the pictures of docs/gallery.md from the scripts on that page: tools/make_gallery.py [PROGRAM]

Above each script stands what is drawn: <!-- picture: NAME --tets N OPTIONS OF laves view -->
"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PICTURE = re.compile(r"<!-- picture: (\w+) --tets (\w+) (.*?) -->\n\n```lua\n(.*?)```", re.S)


def main():
    program = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "laves").resolve()
    page = (ROOT / "docs" / "gallery.md").read_text()
    with tempfile.TemporaryDirectory() as folder:
        for name, tets, how, script in PICTURE.findall(page):
            (pathlib.Path(folder) / f"{name}.lua").write_text(script)
            mesh = pathlib.Path(folder) / f"{name}.vtu"
            made = subprocess.run([program, "mesh", f"{name}.lua", "--tets", tets, "-q", "--certificate", "none", "-o", mesh], cwd=folder)
            if made.returncode not in (0, 3):
                sys.exit(f"{name} cannot be meshed")
            subprocess.run([program, "view", mesh, *how.split(), "--size", "360x270", "-o", ROOT / "docs" / "images" / f"gallery-{name}.png"],
                           check=True)


main()

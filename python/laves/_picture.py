"""Pictures of meshes, drawn by the program that came with the package."""
import base64
import os
import subprocess
import tempfile

from ._library import program_path


def picture_of(mesh, options=()) -> "bytes | None":
    """A PNG, or None where there is no program to draw it."""
    program = program_path()
    if program is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        solid, drawn = os.path.join(folder, "mesh.vtu"), os.path.join(folder, "mesh.png")
        mesh.write(solid, compression=0)
        run = subprocess.run([str(program), "view", solid, "-o", drawn, "--quiet", *options], capture_output=True, check=False)
        if run.returncode != 0:
            raise RuntimeError(run.stderr.decode("utf-8", "replace").strip())
        with open(drawn, "rb") as file:
            return file.read()


def html_of(mesh, rows) -> str:
    """The picture beside a table."""
    table = "".join(f"<tr><th style='text-align:left'>{name}</th><td style='text-align:left'>{value}</td></tr>" for name, value in rows)
    drawn = None
    if not mesh.streamed:
        try:
            drawn = picture_of(mesh, ("--cut", "y", "--size", "480x360"))
        except (OSError, RuntimeError):  # a table says more than no answer
            drawn = None
    image = f"<img alt='the mesh, cut open' src='data:image/png;base64,{base64.b64encode(drawn).decode()}'/>" if drawn else ""
    return f"<div style='display:flex;gap:1em;align-items:center'>{image}<table>{table}</table></div>"

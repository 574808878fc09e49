"""The wheel: what is in it, and that pip installs it into a fresh environment without a network.

    test_wheel.py           packs the library and the program of this build
    test_wheel.py --full    compiles them, as `pip install .` does in a clean checkout; .ci/run does that once. With a folder in
                            LAVES_WHEEL_FOLDER, sources and build (`build`) stay there, for tests/install/packages"""
import base64
import csv
import hashlib
import io
import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest
import zipfile

import support
from support import ROOT

import laves

FULL = "--full" in sys.argv
if FULL:
    sys.argv.remove("--full")

KEPT = os.environ.get("LAVES_WHEEL_FOLDER")
CLEAN = {name: value for name, value in os.environ.items() if not name.startswith(("LAVES_", "PYTHONPATH", "PIP_"))}

TRY = """
import laves, numpy, pathlib, sys
package = pathlib.Path(laves.__file__).parent
assert sys.prefix in str(package), package
assert sys.prefix in str(laves.program_path()), laves.program_path()
mesh = laves.mesh(lambda p: numpy.linalg.norm(p, axis=1) - 1, bounds=[[-1.2] * 3, [1.2] * 3], size=0.2)
assert mesh.certificate.promise_holds
assert (package / "py.typed").exists()
assert b"PNG" in mesh.picture()[:4]
print(mesh.hash)
"""


def have(module):
    return subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True, check=False).returncode == 0


@unittest.skipUnless(have("ensurepip") and have("pip"), "SKIPPED: pip or venv is missing (Debian: python3-pip, python3-venv)")
class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if KEPT:
            shutil.rmtree(KEPT, ignore_errors=True)
            os.makedirs(KEPT)
            cls.folder = os.path.abspath(KEPT)
        else:
            cls.folder = tempfile.mkdtemp()
            cls.addClassCleanup(shutil.rmtree, cls.folder)
        if FULL:
            name = cls.by_pip()
        else:
            name = cls.by_backend("build_wheel", {"library": os.environ["LAVES_LIBRARY"], "program": os.environ["LAVES_PROGRAM"]})
        cls.wheel = pathlib.Path(cls.folder, name)

    @classmethod
    def by_backend(cls, function, *settings):
        """Calls the backend as pip would; the name of what it made in the folder."""
        code = f"import laves_build; print(laves_build.{function}({cls.folder!r}, *{settings!r}))"
        return subprocess.check_output([sys.executable, "-c", code], text=True, cwd=ROOT,
                                       env={**CLEAN, "PYTHONPATH": str(ROOT / "python" / "backend")}).split()[-1]

    @classmethod
    def by_pip(cls):
        """The whole way of pip, by pyproject.toml, from a copy of what is under version control."""
        name = cls.by_backend("build_sdist")
        with tarfile.open(pathlib.Path(cls.folder, name)) as archive:
            archive.extractall(cls.folder)
        settings = ["--config-settings", f"build-dir={os.path.join(cls.folder, 'build')}"] if KEPT else []
        subprocess.check_call([sys.executable, "-m", "pip", "wheel", "--quiet", "--no-index", "--no-deps", *settings, "--wheel-dir",
                               cls.folder, pathlib.Path(cls.folder, name[:-len(".tar.gz")])], env=CLEAN)
        return next(pathlib.Path(cls.folder).glob("*.whl")).name

    def test_content(self):
        self.assertRegex(self.wheel.name, r"^laves-[\d.]+-py3-none-linux_\w+\.whl$")
        with zipfile.ZipFile(self.wheel) as archive:
            names = archive.namelist()
            record = next(n for n in names if n.endswith("/RECORD"))
            rows = list(csv.reader(io.StringIO(archive.read(record).decode())))
            self.assertEqual([row[0] for row in rows], names)
            for name, digest, size in rows[:-1]:
                content = archive.read(name)
                self.assertEqual(digest, "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode())
                self.assertEqual(int(size), len(content))
            program = archive.getinfo("laves/bin/laves")
            self.assertTrue(program.external_attr >> 16 & 0o111)
        expected = {f"laves/{p.name}" for p in (ROOT / "python" / "laves").iterdir() if p.suffix in (".py", ".typed")}
        self.assertEqual(expected - set(names), set())
        self.assertEqual([n for n in names if n.startswith("laves/lib/liblaves.so")] != [], True)

    def test_it_installs_and_works(self):
        home = pathlib.Path(self.folder, "venv")
        subprocess.check_call([sys.executable, "-m", "venv", "--system-site-packages", home])
        python = home / "bin" / "python"
        subprocess.check_call([python, "-m", "pip", "install", "--quiet", "--no-index", "--disable-pip-version-check", self.wheel],
                              env=CLEAN)
        made = subprocess.check_output([python, "-c", TRY], text=True, env=CLEAN, cwd=self.folder).strip()
        here = laves.mesh(lambda p: support.np.linalg.norm(p, axis=1) - 1, bounds=support.BOX, size=0.2)
        self.assertEqual(made, here.hash)
        for command in ([python, "-m", "laves"], [home / "bin" / "laves"]):
            said = subprocess.run([*command, "--version"], capture_output=True, text=True, env=CLEAN, check=True)
            self.assertEqual(said.stdout + said.stderr, f"laves {laves.__version__}\n")

    def test_source_archive(self):
        self.by_backend("build_sdist")
        with tarfile.open(next(pathlib.Path(self.folder).glob("*.tar.gz"))) as archive:
            names = archive.getnames()
        base = names[0].split("/")[0]
        for needed in ("PKG-INFO", "pyproject.toml", "VERSION", "LICENSE", "CMakeLists.txt", "include/laves/laves.h", "src/pipeline.c",
                       "python/laves/__init__.py", "python/backend/laves_build.py"):
            self.assertIn(f"{base}/{needed}", names)
        self.assertFalse([n for n in names if "__pycache__" in n or "/build/" in n])


if __name__ == "__main__":
    support.main()

"""Builds the wheel of the Python package (PEP 517) with CMake and nothing but the standard library.

The binding loads the library by ctypes, so one wheel serves every Python 3 of a platform: its tag is py3-none-PLATFORM. It carries the
shared library and the program. Settings, as in `pip wheel . --config-settings build-dir=DIR`:

    build-dir=DIR           where CMake builds; kept, so that a second build is quick. Else a temporary folder
    cmake-args=ARGS         more for CMake, split at spaces
    library=FILE            a shared library that is built already, and
    program=FILE            a program: nothing is compiled then
"""
import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import time
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAME = "laves"
VERSION = (ROOT / "VERSION").read_text().split()[0]
DIST_INFO = f"{NAME}-{VERSION}.dist-info"

METADATA = f"""Metadata-Version: 2.1
Name: {NAME}
Version: {VERSION}
Summary: Fills any solid with nearly regular tetrahedra
License: MIT
License-File: LICENSE
Classifier: License :: OSI Approved :: MIT License
Classifier: Operating System :: POSIX :: Linux
Classifier: Programming Language :: C
Classifier: Programming Language :: Python :: 3
Classifier: Topic :: Scientific/Engineering
Classifier: Typing :: Typed
Requires-Python: >=3.8
Requires-Dist: numpy>=1.17
Provides-Extra: meshio
Requires-Dist: meshio; extra == "meshio"
Provides-Extra: pyvista
Requires-Dist: pyvista; extra == "pyvista"
Description-Content-Type: text/markdown

"""
ENTRY_POINTS = "[console_scripts]\nlaves = laves.__main__:main\n"


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []


def platform_tag():
    return re.sub(r"[-.]", "_", sysconfig.get_platform())


def metadata():
    """The files of the .dist-info folder but for RECORD."""
    return {
        "METADATA": METADATA + (ROOT / "python" / "README.md").read_text(encoding="utf-8"),
        "WHEEL": f"Wheel-Version: 1.0\nGenerator: laves_build ({VERSION})\nRoot-Is-Purelib: false\nTag: py3-none-{platform_tag()}\n",
        "entry_points.txt": ENTRY_POINTS,
        "LICENSE": (ROOT / "LICENSE").read_text(encoding="utf-8"),
    }


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    folder = pathlib.Path(metadata_directory) / DIST_INFO
    folder.mkdir(parents=True)
    for name, text in metadata().items():
        (folder / name).write_text(text, encoding="utf-8")
    return DIST_INFO


# ---- the library and the program ----


def run(*command):
    """A command whose output is shown only where it fails."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        sys.stderr.write(done.stdout.decode("utf-8", "replace"))
        raise SystemExit(f"laves: {' '.join(map(str, command[:4]))} ... ended with {done.returncode}")


def compile_into(prefix, settings):
    """Library and program, by CMake, in `lib` and `bin` of the prefix."""
    cmake = shutil.which("cmake")
    if not cmake:
        raise SystemExit("laves: building needs CMake, a C compiler, zlib and Lua 5.4; on Debian `tools/setup build` installs them")
    folder = settings.get("build-dir") or os.path.join(prefix, "build")
    generator = ["-G", "Ninja"] if shutil.which("ninja") and not os.path.exists(os.path.join(folder, "CMakeCache.txt")) else []
    run(cmake, "-S", ROOT, "-B", folder, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_SHARED_LIBS=ON", "-DLAVES_TESTS=OFF",
        "-DLAVES_PROGRAM=ON", "-DCMAKE_INSTALL_LIBDIR=lib", *settings.get("cmake-args", "").split())
    run(cmake, "--build", folder, "--parallel", str(os.cpu_count() or 1))
    run(cmake, "--install", folder, "--prefix", prefix, "--strip")


def binaries(prefix, settings):
    """(path within the wheel, file) of library and program. The library has the name by which the program asks for it."""
    if settings.get("library"):
        yield "laves/lib/liblaves.so", pathlib.Path(settings["library"])
        if settings.get("program"):
            yield "laves/bin/laves", pathlib.Path(settings["program"])
        return
    compile_into(prefix, settings)
    name = f"liblaves.so.{'.'.join(VERSION.split('.')[:2])}"
    yield "laves/lib/" + name, (pathlib.Path(prefix) / "lib" / name).resolve()
    yield "laves/bin/laves", pathlib.Path(prefix) / "bin" / "laves"


# ---- the wheel ----


class Wheel:
    """A zip file with a record of what is in it. The same content gives the same bytes."""

    def __init__(self, path):
        self.zip = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED)
        self.record = []
        self.date = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", 0)), 315532800))[:6]

    def add(self, name, content, mode=0o644):
        content = content.encode("utf-8") if isinstance(content, str) else content
        entry = zipfile.ZipInfo(name, self.date)
        entry.external_attr = (0o100000 | mode) << 16
        entry.compress_type = zipfile.ZIP_DEFLATED
        self.zip.writestr(entry, content)
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        self.record.append(f"{name},sha256={digest},{len(content)}")

    def close(self):
        name = f"{DIST_INFO}/RECORD"
        self.add(name, "\n".join([*self.record, f"{name},,", ""]))
        self.zip.close()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    settings = {name: value for name, value in (config_settings or {}).items() if isinstance(value, str)}
    name = f"{NAME}-{VERSION}-py3-none-{platform_tag()}.whl"
    with tempfile.TemporaryDirectory() as prefix:
        wheel = Wheel(os.path.join(wheel_directory, name))
        for path in sorted((ROOT / "python" / NAME).iterdir()):
            if path.suffix == ".py" or path.name == "py.typed":
                wheel.add(f"{NAME}/{path.name}", path.read_bytes())
        for target, path in binaries(prefix, settings):
            wheel.add(target, path.read_bytes(), 0o755)
        for file, text in metadata().items():
            wheel.add(f"{DIST_INFO}/{file}", text)
        wheel.close()
    return name


def sources():
    """All files that are under version control; where there is none, all that look so."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=False) if (ROOT / ".git").exists() else None
    if listed is not None and listed.returncode == 0:
        return sorted(name for name in listed.stdout.decode().split("\0") if name and (ROOT / name).is_file())
    left_out = re.compile(r"(^|/)(build[^/]*|out|\.git|__pycache__)/|\.(o|pyc|whl)$")
    names = (str(path.relative_to(ROOT)) for path in ROOT.rglob("*") if path.is_file())
    return sorted(name for name in names if not left_out.search(name))


def build_sdist(sdist_directory, config_settings=None):
    base = f"{NAME}-{VERSION}"
    with tarfile.open(os.path.join(sdist_directory, base + ".tar.gz"), "w:gz") as archive, tempfile.TemporaryDirectory() as folder:
        info = pathlib.Path(folder) / "PKG-INFO"
        info.write_text(metadata()["METADATA"], encoding="utf-8")
        archive.add(info, f"{base}/PKG-INFO")
        for name in sources():
            archive.add(ROOT / name, f"{base}/{name}")
    return base + ".tar.gz"

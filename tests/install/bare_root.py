#!/usr/bin/env python3
"""Usage: bare_root.py ROOT PACKAGE...
Makes a root folder that holds Debian's essential packages, those named and what these depend on, and nothing else, in seconds and
without a network: their files and dpkg's records of them are copied from the system that runs, on which they must be installed."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

FIELDS = ["binary:Package", "Package", "Architecture", "Provides", "Essential", "Pre-Depends", "Depends", "Status"]
INFO = pathlib.Path("/var/lib/dpkg/info")


def installed():
    """Rows of what is installed, by name; and what is provided by which."""
    form = "".join("${%s}\\t" % field for field in FIELDS) + "\\n"
    rows, providers = {}, {}
    for line in subprocess.check_output(["dpkg-query", "-W", "-f", form], text=True).splitlines():
        row = dict(zip(FIELDS, line.split("\t")))
        if not row["Status"].endswith(" installed"):
            continue
        rows.setdefault(row["Package"], row)
        for name in names_of(row["Provides"]):
            providers.setdefault(name[0], row["Package"])
    return rows, providers


def names_of(relation):
    """[[alternatives of a dependence], ...]"""
    return [[re.split(r"[ (:]", one.strip())[0] for one in part.split("|")] for part in relation.split(",") if part.strip()]


def closure(wanted, rows, providers):
    found, left = set(), [name for name, row in rows.items() if row["Essential"] == "yes"] + list(wanted)
    while left:
        name = left.pop()
        if name not in rows:
            sys.exit(f"bare_root: {name} is not installed here")
        if name in found:
            continue
        found.add(name)
        for choices in names_of(rows[name]["Pre-Depends"]) + names_of(rows[name]["Depends"]):
            there = [choice if choice in rows else providers[choice] for choice in choices if choice in rows or choice in providers]
            left += there[:1]
    return found


def copy(root, path):
    """A file, link or folder to the same place; folders above it may be links (/bin to usr/bin)."""
    place = pathlib.Path(os.path.realpath(os.path.dirname(path)), os.path.basename(path))
    target = pathlib.Path(str(root) + str(place))
    if os.path.lexists(target) or not os.path.lexists(place):
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    if place.is_symlink():
        target.symlink_to(os.readlink(place))
    elif place.is_dir():
        target.mkdir()
    elif place.is_file():
        shutil.copy2(place, target)


def copy_records(root, names, rows):
    """dpkg's own: what is installed, and its alternatives, whose links belong to no package."""
    for folder in ("info", "updates", "triggers", "parts", "alternatives"):
        (root / "var/lib/dpkg" / folder).mkdir(parents=True, exist_ok=True)
    status = pathlib.Path("/var/lib/dpkg/status").read_text(encoding="utf-8")
    parts = [part for part in status.split("\n\n") if re.match(r"Package: (\S+)", part) and re.match(r"Package: (\S+)", part)[1] in names]
    (root / "var/lib/dpkg/status").write_text("\n\n".join(parts) + "\n\n", encoding="utf-8")
    (root / "var/lib/dpkg/available").touch()
    shutil.copy2(INFO / "format", root / "var/lib/dpkg/info/format")
    for name in names:
        for stem in {name, rows[name]["binary:Package"], f"{name}:{rows[name]['Architecture']}"}:
            for file in INFO.glob(stem + ".*"):
                shutil.copy2(file, root / "var/lib/dpkg/info" / file.name)
    for record in pathlib.Path("/var/lib/dpkg/alternatives").iterdir():
        for link in [line for line in record.read_text().splitlines() if line.startswith("/") and os.path.islink(line)]:
            choice = os.readlink(link)
            if choice.startswith("/etc/alternatives/") and os.path.exists(str(root) + os.path.realpath(link)):
                copy(root, link)
                copy(root, choice)


def main():
    root = pathlib.Path(sys.argv[1])
    rows, providers = installed()
    names = closure(sys.argv[2:], rows, providers)
    root.mkdir(parents=True)
    for folder in ("bin", "sbin", "lib", "lib64"):
        copy(root, "/" + folder)
    for name in sorted(names):
        for path in subprocess.check_output(["dpkg-query", "-L", rows[name]["binary:Package"]], text=True).splitlines():
            if path.startswith("/") and path != "/.":
                copy(root, path)
    copy_records(root, names, rows)
    (root / "tmp").mkdir(exist_ok=True)
    for file in ("passwd", "group"):
        copy(root, "/etc/" + file)
    print(f"bare_root: {len(names)} packages")


main()

#!/usr/bin/env python3
"""Checks what no compiler looks at: links between documents lead somewhere, and sources named by a key are in docs/references.bib."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIBLIOGRAPHY = ROOT / "docs" / "references.bib"
KEY = re.compile(r"\[([a-z]+\d{4}|isotropic-tcp|iso\d+)\]")


def files(*patterns):
    folders = ("src", "cli", "docs", "python", "tools", "tests", "demo", "bench", "examples")
    found = list(ROOT.glob("*.md"))
    for pattern in patterns:
        found += [path for folder in folders for path in (ROOT / folder).rglob(pattern)]
    return sorted(found)


def dead_links():
    for path in files("*.md"):
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", path.read_text()):
            if "://" not in target and not (path.parent / target).exists():
                yield f"{path.relative_to(ROOT)}: there is no {target}"


def unknown_keys():
    known = set(re.findall(r"^@\w+\{([^,]+),", BIBLIOGRAPHY.read_text(), re.M))
    for path in files("*.md", "*.c", "*.h", "*.py"):
        for key in sorted(set(KEY.findall(path.read_text())) - known):
            yield f"{path.relative_to(ROOT)}: [{key}] is not in {BIBLIOGRAPHY.relative_to(ROOT)}"


def main():
    faults = [*dead_links(), *unknown_keys()]
    if faults:
        sys.exit("\n".join(faults))


main()

#!/usr/bin/env python3
"""Usage: symbols.py LIBRARY HEADER: a shared library shows what the header declares, and nothing else."""
import re
import subprocess
import sys

library, header = sys.argv[1:]
listed = subprocess.check_output(["nm", "--dynamic", "--defined-only", "--format=posix", library], text=True)
shown = {line.split()[0].split("@")[0] for line in listed.splitlines()}
with open(header, encoding="utf-8") as file:
    declared = set(re.findall(r"^LAVES_API [^;(]*?(\w+)\(", file.read(), re.M))
if len(declared) < 50:
    sys.exit(f"symbols: only {len(declared)} declarations were found in {header}")
for name in sorted(declared - shown):
    print(f"symbols: {name} is declared, and the library does not show it")
for name in sorted(shown - declared):
    print(f"symbols: the library shows {name}, which is not declared")
print(f"symbols: {len(shown)} shown, {len(declared)} declared")
sys.exit(shown != declared)

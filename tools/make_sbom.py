#!/usr/bin/env python3
"""Writes the bill of materials of laves as SPDX 2.3 JSON: what it is made from, linked with and built by, with versions and licences.

    tools/make_sbom.py --zlib 1.2.13 --lua 5.4.4 [--static] [-o laves.spdx.json]

What the page of reports is bundled from stands in web/package-lock.json; three.js alone is in the program, the rest builds or tests.
The date is SOURCE_DATE_EPOCH's where that is set, so that the same sources give the same bytes."""
import argparse
import base64
import datetime
import hashlib
import json
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUNDLED = ("three",)  # into cli/report_template.html
TESTED_WITH = ("playwright-core",)


def moment():
    seconds = os.environ.get("SOURCE_DATE_EPOCH")
    time = datetime.datetime.fromtimestamp(int(seconds), datetime.timezone.utc) if seconds else datetime.datetime.now(datetime.timezone.utc)
    return time.strftime("%Y-%m-%dT%H:%M:%SZ")


def package(name, version, licence, location, **more):
    return {"SPDXID": f"SPDXRef-{name.replace('_', '-')}", "name": name, "versionInfo": version, "downloadLocation": location,
            "filesAnalyzed": False, "licenseConcluded": licence, "licenseDeclared": licence, "copyrightText": "NOASSERTION", **more}


def reference(url):
    return [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": url}]


def npm_packages():
    """Those of the lock file that are not one of many platforms' builds of another."""
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))
    for path, entry in sorted(lock["packages"].items()):
        if not path or entry.get("optional"):
            continue
        name = path.split("node_modules/")[-1]
        algorithm, _, digest = entry["integrity"].partition("-")
        yield package(name, entry["version"], entry["license"], "NOASSERTION",
                      checksums=[{"algorithm": algorithm.upper(), "checksumValue": base64.b64decode(digest).hex()}],
                      externalRefs=reference(f"pkg:npm/{name}@{entry['version']}"))


def relation(one, kind, other):
    return {"spdxElementId": f"SPDXRef-{one}", "relationshipType": kind, "relatedSpdxElement": f"SPDXRef-{other}"}


def bill(options):
    version = (ROOT / "VERSION").read_text().split()[0]
    laves = package("laves", version, "MIT", "NOASSERTION", primaryPackagePurpose="LIBRARY")
    laves["copyrightText"] = next(line for line in (ROOT / "LICENSE").read_text().splitlines() if line.startswith("Copyright"))
    zlib = package("zlib", options.zlib, "Zlib", "https://zlib.net", externalRefs=reference(f"pkg:generic/zlib@{options.zlib}"))
    lua = package("lua", options.lua, "MIT", "https://www.lua.org/ftp/", externalRefs=reference(f"pkg:generic/lua@{options.lua}"))
    modules = list(npm_packages())
    linked = "STATIC_LINK" if options.static else "DYNAMIC_LINK"
    relations = [relation("DOCUMENT", "DESCRIBES", "laves"), relation("laves", linked, "zlib"), relation("laves", linked, "lua")]
    for module in modules:
        name = module["name"]
        if name in BUNDLED:
            relations.append(relation("laves", "CONTAINS", name))
        else:
            relations.append(relation(name, "TEST_TOOL_OF" if name in TESTED_WITH else "BUILD_TOOL_OF", "laves"))
    document = {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"laves-{version}",
                "creationInfo": {"created": moment(), "creators": [f"Tool: make_sbom.py-{version}"]},
                "packages": [laves, zlib, lua, *modules], "relationships": relations}
    digest = hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()[:32]
    document["documentNamespace"] = f"https://spdx.org/spdxdocs/laves-{version}-{digest}"
    return document


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--zlib", required=True, help="version that is linked")
    arguments.add_argument("--lua", required=True, help="version that is linked")
    arguments.add_argument("--static", action="store_true", help="both are linked statically")
    arguments.add_argument("-o", "--output", help="file; none: the standard output")
    options = arguments.parse_args()
    text = json.dumps(bill(options), indent=2, ensure_ascii=False) + "\n"
    if options.output:
        pathlib.Path(options.output).write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)


if __name__ == "__main__":
    main()

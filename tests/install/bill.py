#!/usr/bin/env python3
"""Usage: bill.py FILE: a bill of materials is SPDX 2.3 as far as a schema would see, and tells what is in the tree."""
import json
import pathlib
import re
import sys

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parents[2]
TEXT = {"type": "string", "minLength": 1}
IDENTITY = {"type": "string", "pattern": r"^SPDXRef-[A-Za-z0-9.-]+$"}
LICENCE = {"enum": ["MIT", "Zlib", "Apache-2.0", "CC0-1.0"]}  # names of SPDX's list that occur here; none is the GPL
HASHES = {"SHA1": 40, "SHA256": 64, "SHA512": 128}
# The fields that the specification (sections 6, 7 and 11) demands, and the values that it allows for those in use.
SCHEMA = {
    "type": "object",
    "required": ["spdxVersion", "dataLicense", "SPDXID", "name", "documentNamespace", "creationInfo", "packages", "relationships"],
    "additionalProperties": False,
    "properties": {
        "spdxVersion": {"const": "SPDX-2.3"}, "dataLicense": {"const": "CC0-1.0"}, "SPDXID": {"const": "SPDXRef-DOCUMENT"},
        "name": TEXT, "documentNamespace": {"type": "string", "pattern": r"^https?://[^#\s]+$"},
        "creationInfo": {
            "type": "object", "required": ["created", "creators"], "additionalProperties": False,
            "properties": {"created": {"type": "string", "pattern": r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$"},
                           "creators": {"type": "array", "minItems": 1,
                                        "items": {"type": "string", "pattern": r"^(Person|Organization|Tool): .+"}}}},
        "packages": {
            "type": "array", "minItems": 4,
            "items": {
                "type": "object", "required": ["SPDXID", "name", "versionInfo", "downloadLocation", "licenseConcluded", "licenseDeclared",
                                               "copyrightText", "filesAnalyzed"],
                "additionalProperties": False,
                "properties": {
                    "SPDXID": IDENTITY, "name": TEXT, "versionInfo": {"type": "string", "pattern": r"^\d+(\.\d+)+"},
                    "downloadLocation": {"type": "string", "pattern": r"^(NOASSERTION|NONE|https?://\S+)$"}, "filesAnalyzed": {"const": False},
                    "licenseConcluded": LICENCE, "licenseDeclared": LICENCE, "copyrightText": TEXT,
                    "primaryPackagePurpose": {"enum": ["APPLICATION", "LIBRARY"]},
                    "checksums": {"type": "array", "items": {"type": "object", "required": ["algorithm", "checksumValue"],
                                                             "properties": {"algorithm": {"enum": list(HASHES)},
                                                                            "checksumValue": {"type": "string", "pattern": "^[0-9a-f]+$"}}}},
                    "externalRefs": {"type": "array", "items": {"type": "object", "properties": {
                        "referenceCategory": {"const": "PACKAGE-MANAGER"}, "referenceType": {"const": "purl"},
                        "referenceLocator": {"type": "string", "pattern": r"^pkg:(npm|generic)/[^@]+@[^@]+$"}}}}}}},
        "relationships": {
            "type": "array", "minItems": 4,
            "items": {"type": "object", "required": ["spdxElementId", "relationshipType", "relatedSpdxElement"], "additionalProperties": False,
                      "properties": {"spdxElementId": IDENTITY, "relatedSpdxElement": IDENTITY,
                                     "relationshipType": {"enum": ["DESCRIBES", "CONTAINS", "DYNAMIC_LINK", "STATIC_LINK", "BUILD_TOOL_OF",
                                                                   "TEST_TOOL_OF"]}}}},
    },
}

bill = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
jsonschema.validate(bill, SCHEMA)
packages = {package["SPDXID"]: package for package in bill["packages"]}
versions = {package["name"]: package["versionInfo"] for package in bill["packages"]}
ways = {(r["spdxElementId"], r["relationshipType"], r["relatedSpdxElement"]) for r in bill["relationships"]}
assert len(packages) == len(bill["packages"]), "an SPDXID is there twice"
for one, _, other in ways:
    assert one in packages or one == "SPDXRef-DOCUMENT", one
    assert other in packages, other
for identity in packages:
    assert any(identity in (one, other) for one, _, other in ways), f"{identity} has no relationship"
for package in bill["packages"]:
    for checksum in package.get("checksums", []):
        assert len(checksum["checksumValue"]) == HASHES[checksum["algorithm"]], package
assert versions["laves"] == (ROOT / "VERSION").read_text().split()[0]
assert ("SPDXRef-DOCUMENT", "DESCRIBES", "SPDXRef-laves") in ways and ("SPDXRef-laves", "CONTAINS", "SPDXRef-three") in ways
wanted = json.loads((ROOT / "web" / "package.json").read_text())["devDependencies"]
for name, version in wanted.items():
    assert versions.get(name) == version, f"{name} {versions.get(name)}, and web/package.json has {version}"
# three.js numbers its releases by the middle number, and the page carries that.
release = versions["three"].split(".")[1]
assert re.search(rf'"{release}(dev)?"', (ROOT / "cli" / "report_template.html").read_text(encoding="utf-8")), f"the page is not of three.js {release}"
print(f"bill: {len(packages)} packages, {len(ways)} relationships")

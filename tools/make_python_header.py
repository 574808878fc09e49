#!/usr/bin/env python3
"""Prints python/laves/_header.py: the enums, structures and functions of include/laves/laves.h as ctypes knows them.

    tools/make_python_header.py            to standard output
    tools/make_python_header.py --write    into its file
    tools/make_python_header.py --layout   instead, a C program that prints how a compiler lays the structures out

The header is read for what it is, a list of plain declarations in one style; what isn't understood ends the script."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADER = ROOT / "include" / "laves" / "laves.h"
TARGET = ROOT / "python" / "laves" / "_header.py"
SCALARS = {"bool": "c_bool", "int": "c_int", "double": "c_double", "size_t": "c_size_t", "int32_t": "c_int32", "int64_t": "c_int64",
           "uint32_t": "c_uint32", "char": "c_char"}


def code_of(text):
    """The header without comments, and without what is for other compilers."""
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    text = re.sub(r"//[^\n]*", "", text)
    return text.replace("\\\n", " ").replace("*const *", "**")


def lists_of(code):
    """The X-macros: the rows of each, as lists of their arguments."""
    found = {}
    for name, body in re.findall(r"#define (LAVES_\w+_LIST)\(X\)([^\n]*)", code):
        found[name] = [re.findall(r'"[^"]*"|[\w.]+', row) for row in re.findall(r"X\(((?:\"[^\"]*\"|[^()\"])*)\)", body)]
    return found


def enum_members(body, lists):
    """The names of an enum's body, in order."""
    list_name = re.search(r"^\s*(LAVES_\w+_LIST)\(", body, re.M)
    if list_name:
        pattern = re.search(r"#define \w+\(name[^)]*\) (\w+?)##name", body)[1]
        members = [pattern + row[0] for row in lists[list_name[1]]]
        rest = re.sub(r"#[^\n]*", "", body[list_name.end():]).split(")", 1)[1]
    else:
        members, rest = [], body
    return members + [m.strip() for m in rest.split(",") if m.strip()]


class Header:
    def __init__(self, text):
        code = code_of(text)
        self.lists = lists_of(code)
        self.enums = {name: enum_members(body, self.lists)
                      for body, name in re.findall(r"typedef enum \w+ \{(.*?)\} (\w+);", code, re.S)}
        self.constants = {name: int(value) for body in re.findall(r"\nenum \{(.*?)\};", code, re.S)
                          for name, value in re.findall(r"(\w+) = (\d+)", body)}
        for members in self.enums.values():
            self.constants.update({m: i for i, m in enumerate(members)})
        self.structs = re.findall(r"typedef struct (\w+) \{(.*?)\n\} \1;", code, re.S)
        self.handles = re.findall(r"typedef struct (\w+) \1;", code)
        self.callbacks = re.findall(r"typedef ([\w ]+?[ *])(\w+_fn)\(([^)]*)\);", code)
        self.functions = re.findall(r"LAVES_API ([\w ]+?[ *])(\w+)\(([^)]*)\);", code)
        said = len(re.findall(r"^LAVES_API", code, re.M))
        if said != len(self.functions):
            sys.exit(f"make_python_header: {said} declarations, but {len(self.functions)} of them were understood")

    def type_of(self, words):
        """The ctypes expression of a C type such as `const double *`."""
        words = words.replace("const", " ").strip()
        stars = words.count("*")
        base = words.replace("*", "").replace("struct", "").strip()
        if base == "void":
            return {0: "None", 1: "c_void_p", 2: "POINTER(c_void_p)"}[stars]
        if base in self.handles:
            return {1: "c_void_p", 2: "POINTER(c_void_p)"}[stars]
        if base == "char" and stars in (1, 2):
            return {1: "c_char_p", 2: "POINTER(c_char_p)"}[stars]
        if base in SCALARS:
            name = SCALARS[base]
        elif base in self.enums:
            name = "c_int"
        elif base in dict(self.structs) or base in {name for _, name, _ in self.callbacks}:
            name = base
            stars -= base.endswith("_fn")
        else:
            sys.exit(f"make_python_header: the type '{words}' is not known")
        return name if stars == 0 else f"POINTER({name})"

    def parameter(self, text):
        """The type of a parameter such as `const double *points` or `const int cells[3]`."""
        text = text.strip()
        if text in ("void", ""):
            return None
        array = re.search(r"\[\w*\]$", text)
        text = re.sub(r"\[\w*\]$", "", text)
        kind = re.match(r"(.*?)(\w+)$", text, re.S)[1]
        return self.type_of(kind + ("*" if array else ""))

    def parameters(self, text):
        return [p for p in map(self.parameter, text.split(",")) if p]

    def declared(self, statement):
        """(name, ctypes expression, C type) for each member of a statement such as `double lower[3], upper[3]`."""
        pointer = re.match(r"([\w ]+?)\(\*(\w+)\)\((.*)\)$", statement, re.S)
        if pointer:
            yield pointer[2], f"CFUNCTYPE({', '.join([self.type_of(pointer[1]), *self.parameters(pointer[3])])})", ""
            return
        kind = re.match(r"((?:const )?\w+ \**)", statement)[1]
        for item in statement[len(kind):].split(","):
            item = item.strip()
            stars = len(item) - len(item.lstrip("*"))
            name, *sizes = re.findall(r"\w+", item)
            expression = self.type_of(kind + "*" * stars)
            for size in reversed(sizes):
                expression = f"{expression} * {self.constants.get(size, size)}"
                if size != sizes[0]:
                    expression = f"({expression})"
            yield name, expression, kind.replace("const", "").strip()

    def members(self, body):
        """(name, ctypes expression, C type) for each member of a structure; nested ones first become classes of their own."""
        nested = re.compile(r"struct \{(.*?)\} (\w+)\[(\w+)\];", re.S)
        body = nested.sub(lambda m: f"NESTED_{m[2]} {m[2]}[{m[3]}];", body)
        for statement in body.split(";"):
            statement = " ".join(statement.split())
            if statement.startswith("NESTED_"):
                name, size = re.match(r"\w+ (\w+)\[(\w+)\]", statement).groups()
                yield name, f"laves_report_{name} * {self.constants[size]}", ""
            elif statement:
                yield from self.declared(statement)

    def nested(self, body):
        return re.findall(r"struct \{(.*?)\} (\w+)\[\w+\];", body, re.S)


def write_class(lines, header, name, body):
    for inner, inner_name in header.nested(body):
        write_class(lines, header, f"{name}_{inner_name}", inner)
    members = list(header.members(body))
    lines += ["", "", f"class {name}(Structure):", "    _fields_ = ["]
    lines += [f'        ("{member}", {expression}),' for member, expression, _ in members]
    lines += ["    ]"]
    kinds = {member: kind for member, _, kind in members if kind in header.enums}
    if kinds:
        lines += [f"    _enums_ = {kinds!r}".replace("'", '"')]


def module_of(header):
    lines = ['"""The declarations of laves.h for ctypes. Made by tools/make_python_header.py; do not edit."""',
             "from ctypes import (CFUNCTYPE, POINTER, Structure, c_bool, c_char, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t,",
             "                    c_uint32, c_void_p)", "", "# Members of the enums, in order, without what they have in common.", "ENUMS = {"]
    for name, members in header.enums.items():
        stem = name.upper() + "_"
        if name == "laves_result":
            stem = "LAVES_"
        elif not all(m.startswith(stem) for m in members):
            stem = {"laves_domain_kind": "LAVES_DOMAIN_", "laves_thin_kind": "LAVES_THIN_",
                    "laves_exception_kind": "LAVES_EXCEPTION_"}[name]
        short = [m[len(stem):] for m in members if not m.endswith("_COUNT")]
        lines += [f'    "{name}": [']
        lines += [f'        "{m}",' for m in short]
        lines += ["    ],"]
    lines += ["}", "", "CONSTANTS = {"]
    lines += [f'    "{name}": {value},' for name, value in header.constants.items()]
    lines += ["}", ""]
    for result, name, parameters in header.callbacks:
        lines += [f"{name} = CFUNCTYPE({', '.join([header.type_of(result), *header.parameters(parameters)])})"]
    for name, body in header.structs:
        write_class(lines, header, name, body)
    lines += ["", "", "# name: (type of the result, types of the arguments)", "FUNCTIONS = {"]
    for result, name, parameters in header.functions:
        lines += [f'    "{name}": ({header.type_of(result)}, [{", ".join(header.parameters(parameters))}]),']
    lines += ["}"]
    return "\n".join(lines) + "\n"


def layout_of(header):
    """A C program that prints the size of each structure and, for each of its members, place and size."""
    lines = ["#include <stdio.h>", '#include "laves/laves.h"', "int main(void) {"]
    for name, body in header.structs:
        lines += [f'  printf("{name} %zu\\n", sizeof({name}));']
        lines += [f'  printf("{name}.{member} %zu %zu\\n", offsetof({name}, {member}), sizeof((({name} *)0)->{member}));'
                  for member, _, _ in header.members(body)]
    return "\n".join([*lines, "  return 0;", "}"]) + "\n"


def main():
    header = Header(HEADER.read_text())
    if sys.argv[1:] == ["--write"]:
        TARGET.write_text(module_of(header))
    else:
        sys.stdout.write(layout_of(header) if sys.argv[1:] == ["--layout"] else module_of(header))


if __name__ == "__main__":
    main()

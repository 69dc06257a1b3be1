#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks which folder includes which. The rule is the column "may include" of src/README.md; beyond it

- public headers (include/wellmesh) include only standard and public headers,
- apps/cli includes public headers and its own files,
- every quoted include names a file that exists.

Usage: check_layers.py [ROOT]. Prints each violation as file:line: message; exit status 1 if there is one.
"""
import pathlib
import re
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s+(["<])([^">]+)[">]')


def read_rule(readme: pathlib.Path) -> dict[str, set[str]]:
    """Folder -> folders that it may include, from the Markdown table."""
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in readme.read_text().splitlines() if line.startswith("|")]
    if not rows or "folder" not in rows[0] or "may include" not in rows[0]:
        sys.exit(f"{readme}: no table with the columns 'folder' and 'may include'")
    folder, allowed = rows[0].index("folder"), rows[0].index("may include")
    return {row[folder]: {name.strip() for name in row[allowed].split(",")} - {"-", ""} for row in rows[2:]}


def includes(path: pathlib.Path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if match := INCLUDE.match(line):
            yield number, match[1] == '"', match[2]


def sources(folder: pathlib.Path):
    return sorted(p for p in folder.rglob("*") if p.suffix in (".hpp", ".cpp"))


def check_stage(root, path, rule):
    stage = path.relative_to(root / "src").parts[0]
    if stage not in rule:
        yield 1, f"folder '{stage}' has no row in src/README.md"
        return
    for number, quoted, name in includes(path):
        first = name.split("/")[0]
        if first == "wellmesh" or (not quoted and first not in rule):
            continue
        if first not in rule or not (root / "src" / name).is_file():
            yield number, f'"{name}" is no file of src/ or include/ (paths are relative to src/)'
        elif first != stage and first not in rule[stage]:
            yield number, f"{stage} must not include {first} ({name})"


def check_public(root, path):
    for number, quoted, name in includes(path):
        is_standard = not quoted and "/" not in name and not name.endswith(".h")
        is_generated = name == "wellmesh/version.hpp"
        if not is_standard and not is_generated and not (root / "include" / name).is_file():
            yield number, f"a public header must not include {name}"


def check_program(root, path):
    for number, quoted, name in includes(path):
        if quoted and not name.startswith("wellmesh/") and not (path.parent / name).is_file():
            yield number, f"the program uses public headers only, not {name}"


def main() -> int:
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
    rule = read_rule(root / "src" / "README.md")
    for stage, allowed in rule.items():
        if unknown := allowed - rule.keys():
            sys.exit(f"src/README.md: {stage} may include unknown folders {sorted(unknown)}")
    checked, violations = 0, 0
    groups = [("src", lambda p: check_stage(root, p, rule)), ("include/wellmesh", lambda p: check_public(root, p)),
              ("apps/cli", lambda p: check_program(root, p))]
    for folder, check in groups:
        for path in sources(root / folder):
            checked += 1
            for number, message in check(path):
                violations += 1
                print(f"{path.relative_to(root)}:{number}: {message}")
    print(f"{checked} files, {violations} violations of the layer rule")
    return 1 if violations or not checked else 0


if __name__ == "__main__":
    sys.exit(main())

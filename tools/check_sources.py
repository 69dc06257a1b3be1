#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks what a compiler does not.

- every source file, script and CMake helper says its licence in its first three lines,
- every key cited in a comment ([Key], [Key, Key], [Key sec. 3]) stands in docs/references.md, and every key there is cited,
- relative links in Markdown files lead somewhere.

Usage: check_sources.py [ROOT]. Prints each violation as file:line: message; exit status 1 if there is one.
"""
import pathlib
import re
import sys

KEY = re.compile(r"\b[A-Z][A-Za-z]+[0-9]{2}[a-z]?\b")
CITATION = re.compile(rf"\[({KEY.pattern}[^\[\]]*)\]")  # [Key], [Key, Key] or [Key sec. 3]
LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)[^)]*\)")
LICENCE = "SPDX-License-Identifier: Apache-2.0"
CODE = (".hpp", ".cpp", ".py", ".in")
FOLDERS = ("include", "src", "apps", "tests", "tools", "benchmarks", "examples")


def files(root, suffixes):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in suffixes and path.is_file() and "fixtures" not in path.relative_to(root).parts:
                yield path


def check_licences(root):
    scripts = [root / name for name in ("quickstart", "run-tests", ".ci/run") if (root / name).is_file()]
    for path in [*files(root, CODE), *sorted((root / "cmake").glob("*.hpp.in")), *scripts]:
        if LICENCE not in "".join(path.read_text().splitlines(keepends=True)[:3]):
            yield path, 1, f"no '{LICENCE}' in the first three lines"


def check_citations(root):
    references = root / "docs" / "references.md"
    known = {match[1]: number for number, line in enumerate(references.read_text().splitlines(), 1)
             if (match := re.match(r"- \*\*\[([^\]]+)\]\*\*", line))}
    cited = set()
    documents = [p for p in sorted((root / "docs").rglob("*.md")) if p != references] + [root / "README.md", root / "src" / "README.md"]
    for path in [*files(root, (".hpp", ".cpp", ".py")), *documents]:
        for number, line in enumerate(path.read_text().splitlines(), 1):
            text = line.partition("//")[2] if path.suffix in (".hpp", ".cpp") else line
            for key in [key for citation in CITATION.findall(text) for key in KEY.findall(citation)]:
                cited.add(key)
                if key not in known:
                    yield path, number, f"[{key}] is not in docs/references.md"
    for key in sorted(known.keys() - cited):
        yield references, known[key], f"[{key}] is cited nowhere"
    if not known:
        yield references, 1, "no references found"


def check_links(root):
    for path in [*sorted((root / "docs").rglob("*.md")), *sorted(root.glob("*.md")), root / "src" / "README.md"]:
        for number, line in enumerate(path.read_text().splitlines(), 1):
            for target in LINK.findall(line):
                if "://" not in target and not target.startswith("mailto:") and not (path.parent / target).exists():
                    yield path, number, f"link to {target} leads nowhere"


def main() -> int:
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
    violations = 0
    for check in (check_licences, check_citations, check_links):
        for path, number, message in check(root):
            violations += 1
            print(f"{path.relative_to(root)}:{number}: {message}")
    print(f"{violations} violations")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())

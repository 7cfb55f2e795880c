"""What would be published: the files of the crate, their size, and the licences of all that it builds on."""

import json
import pathlib
import re
import subprocess

import pytest

tomllib = pytest.importorskip("tomllib")

ROOT = pathlib.Path(__file__).parents[2]
# Bytes of the crate before compression: sources, kernels and pages.
SIZE_MAX = 10_000_000


def cargo(*arguments):
    out = subprocess.run(["cargo", *arguments], cwd=ROOT, capture_output=True, text=True)
    assert out.returncode == 0, out.stderr
    return out.stdout


def test_the_crate_holds_what_builds_it_and_no_more():
    files = [f for f in cargo("package", "--list", "--allow-dirty").splitlines() if (ROOT / f).is_file()]
    tops = {f.split("/")[0] for f in files}
    whole = {"README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE-MIT", "LICENSE-APACHE", "Cargo.toml", "Cargo.lock"}
    assert tops == whole | {"src", "wgsl", "docs"}
    assert sum((ROOT / f).stat().st_size for f in files) < SIZE_MAX
    # no path of the machine that it was made on
    leaks = [f for f in files if str(ROOT).encode() in (ROOT / f).read_bytes()]
    assert not leaks or len(ROOT.parts) < 3, leaks


def is_allowed(expression, allowed):
    """Whether an SPDX expression can be met by the licences that are allowed."""
    words = re.findall(r"[()]|AND|OR|(?:(?!AND\b|OR\b)[\w.+-]+)(?: WITH [\w.+-]+)?", expression.replace("/", " OR "))
    operators = {"(": "(", ")": ")", "AND": "and", "OR": "or"}
    return eval(" ".join(operators.get(word, str(word in allowed)) for word in words))


def test_all_licences_are_allowed():
    allowed = tomllib.loads((ROOT / "deny.toml").read_text())["licenses"]["allow"]
    packages = json.loads(cargo("metadata", "--locked", "--format-version", "1", "--all-features"))["packages"]
    assert len(packages) > 100
    refused = [(p["name"], p["license"]) for p in packages if not is_allowed(p["license"] or "none", allowed)]
    assert not refused


@pytest.mark.parametrize(
    "expression, allowed, expected",
    [
        ("MIT OR Apache-2.0", ["MIT"], True),
        ("MIT/Apache-2.0", ["MIT"], True),
        ("(MIT OR GPL-3.0) AND Unicode-3.0", ["MIT"], False),
        ("Apache-2.0 WITH LLVM-exception", ["Apache-2.0"], False),
        ("GPL-3.0-or-later", ["MIT"], False),
    ],
)
def test_expressions_are_read(expression, allowed, expected):
    assert is_allowed(expression, allowed) is expected

"""The files that a release needs: workflows, citation, metadata; and the completion of the shell."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import echocal

ROOT = Path(__file__).parents[1]
BIN = Path(sys.executable).parent


def output(*command: str, **environment: str) -> str:
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, env={**os.environ, **environment}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize(
    ("schema", "path"),
    [
        ("vendor.github-workflows", ".github/workflows/ci.yml"),
        ("vendor.github-workflows", ".github/workflows/wheels.yml"),
        ("vendor.dependabot", ".github/dependabot.yml"),
        ("vendor.citation-file-format", "CITATION.cff"),
    ],
)
def test_files_have_their_schema(schema: str, path: str) -> None:
    output(str(BIN / "check-jsonschema"), "--builtin-schema", schema, path)


def test_no_test_is_left_out_for_want_of_a_package() -> None:
    """What a test skips without is installed by the gate, by the extras test and bench."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    named = " ".join([*project["dependencies"], *extras["test"], *extras["bench"]])
    under_others = {"paho": "paho-mqtt", "sklearn": "scikit-learn", "cloudpickle": "distributed"}
    under_others |= {
        "python_calamine": "python-calamine",
        "serial": "pyserial",
        "rattler_build": "py-rattler-build",
    }
    for path in (ROOT / "tests").rglob("test_*.py"):
        for name in re.findall(r"importorskip\(\s*\"(\w+)", path.read_text()):
            assert name == "fcntl" or re.search(rf"\b{under_others.get(name, name)}\b", named), (
                path.name,
                name,
            )


def test_the_conda_recipe_is_rendered_and_needs_what_the_wheel_needs() -> None:
    rattler = pytest.importorskip("rattler_build")
    recipe = rattler.Stage0Recipe.from_file(str(ROOT / "recipe/recipe.yaml"))
    compilers = {"c_compiler": ["gcc"], "rust_compiler": ["rust"], "c_stdlib": ["sysroot"]}
    (rendered,) = recipe.render(rattler.VariantConfig(compilers | {"python": ["3.11.*"]}))
    made = rendered.recipe.to_dict()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    version = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    assert made["package"] == {"name": "echocal", "version": version}
    needs = [f"python{project['project']['requires-python']}", *project["project"]["dependencies"]]
    plain = [
        one.replace(" ", "").replace("matplotlib-base", "matplotlib") for one in made["requirements"]["run"]
    ]
    assert sorted(plain) == sorted(needs)
    builds = [one.replace(" ", "") for one in made["requirements"]["host"]]
    assert set(project["build-system"]["requires"]) <= set(builds)
    assert made["about"]["summary"] == project["project"]["description"]
    for file in made["about"]["license_file"]:
        assert (ROOT / file).is_file()
    text = (ROOT / "recipe/recipe.yaml").read_text()
    with pytest.raises(rattler.RecipeParseError):
        rattler.Stage0Recipe.from_yaml(text.replace("  run:", "  runs:"))


def test_workflows_are_safe() -> None:
    output(str(BIN / "zizmor"), "--offline", "--quiet", ".github")


def test_the_workflow_builds_what_the_issue_of_a_release_needs() -> None:
    text = (ROOT / ".github/workflows/wheels.yml").read_text(encoding="utf-8")
    for name in ("linux-x86_64", "linux-aarch64", "macos-x86_64", "macos-aarch64", "windows-x86_64", "sdist"):
        assert name in text


def test_one_version_everywhere() -> None:
    cargo = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))
    version = cargo["workspace"]["package"]["version"]
    assert echocal.__version__ == version
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"## {version}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_changelog_is_one_page() -> None:
    assert len((ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split()) < 1500


def test_python_versions_are_those_of_the_wheel() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["requires-python"] == ">=3.11"
    assert "abi3-py311" in (ROOT / "rust/py/Cargo.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_shell_completes(shell: str) -> None:
    script = output(str(BIN / "echocal"), "--show-completion", shell)
    assert "_ECHOCAL_COMPLETE" in script
    assert script.strip()


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("diagnose log.csv --base cra", {"cramer"}),
        ("log.csv --base cra", {"cramer"}),
        ("bench --base cra", {"cramer"}),
        ("sweep --law cra", {"cramer"}),
        ("verify model.json --law cra", {"cramer"}),
        ("watch log.csv --effect fixed_del", {"fixed_delay:delay="}),
        ("calibrate log.csv --fit fixed_del", {"fixed_delay.delay"}),
        ("firmware model.json --target cortex-m0", {"cortex-m0"}),
        ("effects show crosst", {"crosstalk"}),
    ],
)
def test_values_are_completed(words: str, found: set[str]) -> None:
    place = {"COMP_WORDS": f"echocal {words}", "COMP_CWORD": str(len(words.split()))}
    assert set(output(str(BIN / "echocal"), _ECHOCAL_COMPLETE="complete_bash", **place).split()) == found


def test_commands_are_completed() -> None:
    words = output(
        str(BIN / "echocal"), _ECHOCAL_COMPLETE="complete_bash", COMP_WORDS="echocal di", COMP_CWORD="1"
    )
    assert words.split() == ["diagnose"]

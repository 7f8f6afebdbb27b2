"""The texts of the mutants of `benches/mutants.py` are in this source, each once, and their tests exist."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "benches"))

import mutants


@pytest.mark.parametrize("mutant", mutants.MUTANTS, ids=lambda mutant: mutant.breaks)
def test_a_mutant_changes_one_place(mutant: mutants.Mutant) -> None:
    file, text = mutants.mutated(mutant, mutants.PACKAGE)
    assert text != file.read_text(encoding="utf-8")
    compile(text, str(file), "exec")
    for test in mutant.tests.split():
        path, *names = test.split("::")
        source = (mutants.ROOT / "tests" / path).read_text(encoding="utf-8")
        assert all(f"def {name}(" in source for name in names)


def test_a_text_that_is_no_longer_there_is_told() -> None:
    gone = mutants.MUTANTS[0]._replace(text="no such text")
    with pytest.raises(SystemExit, match=r"0 times in .*, not once"):
        mutants.mutated(gone, mutants.PACKAGE)

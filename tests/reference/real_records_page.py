"""Write docs/real-records.md: what an analyst finds in real records, and what the engine says.

python tests/reference/real_records_page.py --write

The analyst's part is real_records.toml beside this file. The engine's part is what tests/frozen holds,
which the tests compare with the engine.
"""

import json
import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "real-records.md"
FROZEN = ROOT / "tests" / "frozen" / "diagnoses.json"


def page() -> str:
    """The page as it should be."""
    given = tomllib.loads((Path(__file__).parent / "real_records.toml").read_text(encoding="utf-8"))
    records = given["record"]
    frozen = json.loads(FROZEN.read_text(encoding="utf-8"))
    found = "".join(f"| {r['name']} | {r['finding']} | {r['share']} | {r['refuted']} |\n" for r in records)
    said = "".join(_line(r["name"], name, frozen[name]) for r in records for name in r["tables"])
    return "".join([given["head"], found, given["middle"], said, given["tail"]])


def _line(record: str, table: str, diagnosis: dict[str, Any]) -> str:
    gain = diagnosis["gain"]
    effects = [
        f"{'possible: ' * cause['doubt']}`{id_}`{_others(cause['rivals'])} {cause['probability']:.2f}"
        for id_, cause in diagnosis["causes"].items()
        if cause["kind"] == "effect"
    ]
    others = [f"`{id_}`" for id_, cause in diagnosis["causes"].items() if cause["kind"] != "effect"]
    if (term := diagnosis["unexplained"]) is not None:
        others.append(f"unexplained, against {term['against']}")
    before, after = 1e3 * gain["rms_before_m"], 1e3 * gain["rms_after_m"]
    share = 1 - (after / before) ** 2
    named = ", ".join(effects) or "none"
    figures = " | ".join(f"{figure:.2f}" for figure in (before, after, share))
    beside = ", ".join(others) or "none"
    return f"| {record} | `{table}` | {diagnosis['verdict']} | {named} | {beside} | {figures} |\n"


def _others(rivals: list[str]) -> str:
    return f" or {len(rivals)} other{'s' * (len(rivals) > 1)}" if rivals else ""


if __name__ == "__main__":
    if "--write" in sys.argv:
        PAGE.write_text(page(), encoding="utf-8")
    else:
        print(page())

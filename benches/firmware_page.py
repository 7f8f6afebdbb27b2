"""The tables of docs/firmware.md from firmware.json."""

import json
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parents[1] / "docs" / "firmware.md"
RESULTS = Path(__file__).with_name("firmware.json")
COSTS = Path(__file__).with_name("costs.json")
BEGIN = "<!-- made by benches/firmware.py from benches/firmware.json; a test checks that they agree -->\n"
END = "<!-- end of what is generated -->\n"
HEAD = (
    "| core | function | air | flash [B] | cycles or instructions | stack [B] | proven, that air [mm] "
    "| dry air [mm] | 0 .. 100 % [mm] |\n"
    "|---|---|---|---|---|---|---|---|---|\n"
)


def line(row: dict[str, Any]) -> str:
    """One function on one core."""
    unit = "instructions" if row["cycles"] is None else "cycles"
    most, fewest = row[unit], row[f"fewest_{unit}"]
    steps = f"{most:,}" if most == fewest else f"{fewest:,} to {most:,}"
    flash, own = row["flash_bytes"], row["own_flash_bytes"]
    parts = f" ({own} + {flash - own})" if own != flash else ""
    label = f"**{row['label']}**: {row['form']}" if "form" in row else row["label"]
    bound = row.get("proven_m")
    errors = [f"{row[air] * 1e3:.3g}" for air in ("dry_m", "humid_m")]
    proven = "" if bound is None else f"**{bound * 1e3:.3f}**"
    stack = str(row["stack_bytes"])
    cells = (row["core"], label, row.get("air", ""), f"{flash}{parts}", steps, stack, proven, *errors)
    return f"| {' | '.join(cells)} |\n"


def tables(results: dict[str, Any]) -> str:
    """The rows of everybody, theirs first."""
    rows = [*results["theirs"], *results["ours"], *results["baked"], *results["humid"]]
    compilers = sorted({row["compiler"] for row in rows})
    simulators = sorted({row["simulator"] for row in rows})
    text = HEAD + "".join(map(line, rows))
    made = f"{', '.join(compilers)}, -Os where nothing else stands"
    return f"{text}\nCompilers: {made}. Simulators: {', '.join(simulators)}.\n"


def residuals() -> str:
    """How well the weights that the search ranks by agree with measured functions."""
    lines = [
        f"| `{target}` | {left['functions']} | {left['size_rms']:.1%} | {left['time_rms']:.1%} |\n"
        for target, left in json.loads(COSTS.read_text()).items()
    ]
    head = "| target | functions measured | flash, RMS | time, RMS |\n|---|---|---|---|\n"
    return (
        "\nThe cost models that the search ranks by, against measured functions:\n\n" + head + "".join(lines)
    )


def fresh(page: str, results: dict[str, Any]) -> str:
    """The page with the tables between its marks made anew."""
    before, rest = page.split(BEGIN)
    _, after = rest.split(END)
    return f"{before}{BEGIN}\n{tables(results)}{residuals()}{END}{after}"

"""What real records show of an HC-SR04, and the same of the virtual bench, by the same functions.

A record is a table with a row for each reading: `session`, `group` (a placement of the target), `order` in
the group, `distance` [m] as the ruler tells it, `temperature` [degC] and `echo` [us].
"""

from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.virtual_bench import Scene, Sensor, Target, measure

Column = NDArray[np.float64]

BANDS = (
    (0.02, 0.1),
    (0.1, 0.2),
    (0.21, 0.4),
    (0.41, 0.6),
    (0.61, 0.8),
    (0.81, 1.0),
    (1.01, 1.25),
    (1.26, 1.5),
)
WALK = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2, 1.4)
SLIP, FURTHER = (15.0, 34.0), 112.0  # us: one cycle off, and what is no slip any more
PERIOD = 25.0  # us
HAND = 0.18  # of the logarithm of the amplitude, from placement to placement: set by hand with the sensor
TILT, PLACED = 0.02, 0.47e-3  # rad, an assumption; m, what the real placements on one cycle scatter by


def desk(folder: Path) -> pd.DataFrame:
    """The record desk-hcsr04: groups of five to ten pings on a Raspberry Pi, 2 to 150 cm."""
    raw = pd.read_csv(folder / "desk-hcsr04" / "hcsr04_known_distance_tidy.csv")
    order = raw["obs"].str.extract(r"(\d+)")[0].astype(int)
    moved = (raw["file"] != raw["file"].shift()) | (raw["true_cm"] != raw["true_cm"].shift())
    group = ((order <= order.shift(fill_value=99)) | moved).cumsum()
    return pd.DataFrame(
        {
            "session": raw["file"],
            "group": group,
            "order": order - 1,
            "distance": 0.01 * raw["true_cm"],
            "temperature": raw["temp_C"],
            "echo": raw["reading_cm"] * 2e4 / (331.3 + 0.606 * raw["temp_C"]),
        }
    ).dropna()


def boxes(folder: Path) -> pd.DataFrame:
    """Runs of the record kb-hcsr04: untouched for minutes; share of readings off the cluster, and spacing."""
    raw = pd.read_csv(folder / "kb-hcsr04" / "all_runs_tidy.csv")
    late = raw["day"] >= "2019-06-03"  # the authors added 55 us then
    raw = raw.assign(echo=1e6 * raw["Measured Time Diff"] - np.where(late, 55.0, 0.0))
    found = []
    for _, run in raw.groupby("run"):
        near = run["echo"][(run["echo"] - run["echo"].median()).abs() < FURTHER]
        if len(near) < max(25, 0.8 * len(run)):
            continue
        off = near - _cluster(near, 12.0)
        cycle = np.round(off / 24.6)
        inside = (off - 24.6 * cycle).abs() < 9
        slips = int((cycle[inside] != 0).sum())
        step = float(np.polyfit(cycle[inside], off[inside], 1)[0]) if slips >= 8 else np.nan
        arduino = run["day"].iloc[0] >= "2019-05-14"
        found.append((arduino, run["L"].iloc[0], float((cycle != 0).mean()), step, len(near)))
    return pd.DataFrame(found, columns=["arduino", "distance", "share", "spacing", "rows"])


def desk_on_the_bench(
    random: np.random.Generator, sensor: Sensor | None = None, times: int = 1
) -> pd.DataFrame:
    """The same campaign on the bench: a metal plate that a hand places on a desk, 14 cm below the sensor.

    Size and tilt of the plate, the desk and the humidity are assumptions: the record tells a metal target
    and a mean of 29 degC.
    """
    near, far = np.arange(2, 21) / 100, np.repeat(np.arange(5, 151, 5) / 100, 3)
    sessions = [(f"near {number}", near, 5) for number in range(17 * times)]
    sessions += [(f"far {number}", far, 10) for number in range(4 * times)]
    rows = [
        pd.DataFrame(
            {
                "session": name,
                "group": np.repeat(np.arange(len(places)), each),
                "order": np.tile(np.arange(each), len(places)),
                "distance": np.repeat(places, each),
            }
        )
        for name, places, each in sessions
    ]
    table = pd.concat(rows, ignore_index=True)
    table["group"] = table.groupby(["session", "group"], sort=False).ngroup()
    hand = random.normal(size=(3, table["group"].max() + 1))[:, table["group"]]
    scene = Scene(
        table["distance"].to_numpy() + PLACED * hand[0],
        temperature=29.0,
        relative_humidity=0.5,
        target=Target(tilt=TILT * hand[1], half_width=0.15, half_height=0.14),
        louder=np.exp(HAND * hand[2]),
        floor=0.14,
        floor_reflectivity=0.9,
    )
    echo = 1e6 * measure(scene, sensor, random).time
    return table.assign(temperature=29.0, echo=echo).dropna(ignore_index=True)


def cycles(record: pd.DataFrame) -> pd.DataFrame:
    """Add how far each reading is from the densest cluster of its group: `off` [us]; first pings left out."""
    rest = record[record["order"] > 0]
    rest = rest[rest.groupby("group")["echo"].transform("size") >= 3]
    return rest.assign(off=rest["echo"] - rest.groupby("group")["echo"].transform(_cluster))


def _cluster(values: pd.Series, width: float = 8.0) -> float:
    """Median of the densest part of this width [us]."""
    ordered = np.sort(values.to_numpy())
    count = np.searchsorted(ordered, ordered + width) - np.arange(len(ordered))
    first = int(count.argmax())
    return float(np.median(ordered[first : first + count[first]]))


def shares(record: pd.DataFrame) -> pd.DataFrame:
    """Share of readings one to four cycles off their group's cluster, by distance, with standard errors."""
    known = cycles(record)
    slipped = known["off"].abs().between(SLIP[0], FURTHER)
    found = []
    for low, high in BANDS:
        here = known["distance"].between(low - 1e-6, high + 1e-6)
        groups = slipped[here].groupby(known["group"]).agg(["sum", "size"])
        share = groups["sum"].sum() / max(groups["size"].sum(), 1)
        spread = groups["sum"] - share * groups["size"]
        error = np.sqrt((spread**2).sum()) / max(groups["size"].sum(), 1)
        gross = (known["off"][here].abs() >= FURTHER).mean()
        found.append((low, high, share, error, gross, len(groups)))
    return pd.DataFrame(found, columns=["low", "high", "share", "error", "gross", "groups"])


def spacing(record: pd.DataFrame) -> tuple[float, float, float]:
    """Mean of the slips of one cycle [us], its standard error, and their standard deviation."""
    off = cycles(record)["off"].abs()
    slips = off[off.between(*SLIP)]
    return float(slips.mean()), float(slips.std() / np.sqrt(len(slips))), float(slips.std())


def scatter(record: pd.DataFrame) -> Column:
    """Standard deviation within a cluster [us], below 10 cm, below 40 cm, and beyond."""
    known = cycles(record)
    inside = known[known["off"].abs() < 9.0]
    grouped = inside.groupby("group")["off"]
    size = grouped.transform("size")
    squares = (inside["off"] - grouped.transform("mean")) ** 2 * size / (size - 1)
    places = np.digitize(inside["distance"], [0.1, 0.4])
    return np.array([np.sqrt(squares[(places == place) & (size >= 3)].mean()) for place in range(3)])


def delays(record: pd.DataFrame) -> pd.DataFrame:
    """Median of each group less the way in dry air [us]."""
    grouped = record[record["order"] > 0].groupby(["session", "group"], sort=False)
    found = grouped.agg({"distance": "first", "temperature": "mean", "echo": "median"}).reset_index()
    speed = 331.3 * np.sqrt(1 + found["temperature"] / 273.15)
    return found.assign(delay=found["echo"] - 2e6 * found["distance"] / speed)


def walk(record: pd.DataFrame) -> pd.DataFrame:
    """Mean delay of the long sessions by distance [us], and its standard error over the sessions."""
    found = delays(record)
    long = found.groupby("session")["distance"].transform("max") > 0.5
    found = found[long & (found["delay"].abs() < 300)]
    means = found.groupby(["session", "distance"])["delay"].mean().reset_index()
    means["distance"] = means["distance"].round(3)
    grouped = means.groupby("distance")["delay"].agg(["mean", "std", "size"])
    return grouped.assign(error=grouped["std"] / np.sqrt(grouped["size"])).reindex(WALK)


def neighbors(record: pd.DataFrame) -> float:
    """Share of placements a cycle from the one before at the same distance."""
    found = delays(record)
    found = found[found["delay"].abs() < 300]
    steps = found.groupby(["session", "distance"])["delay"].diff().dropna().abs()
    return float(steps.between(16, 34).mean())


def branches(record: pd.DataFrame) -> tuple[pd.DataFrame, dict[str, float]]:
    """Placements at 4 to 20 cm on a comb of cycles.

    The comb slides along a curve `a + b d + c / d`; its spacing is the one that leaves the least.
    """
    found = delays(record)
    near = found.groupby("session")["distance"].transform("max") < 0.25
    found = found[near & found["distance"].between(0.035, 0.205)].reset_index(drop=True)
    far, delay = found["distance"].to_numpy(), found["delay"].to_numpy()
    basis = np.column_stack([np.ones_like(far), far, 1 / far])
    trials = [(p, part) for p in np.arange(23.0, 26.61, 0.1) for part in np.linspace(-0.5, 0.5, 5)]
    fits = [_comb(delay, basis, period, part * period) for period, part in trials]
    misses = [np.median(np.abs(rest)) for _, rest in fits]
    best = int(np.argmin(misses))
    cycle, rest = fits[best]
    period = float(trials[best][0])
    cycle = cycle - pd.Series(cycle).mode()[0]
    share = pd.Series(cycle).value_counts(normalize=True)
    inside = np.abs(rest) < 9
    numbers = {
        "period": period,
        "main": float(share.iloc[0]),
        "other": float(share.iloc[1]) if len(share) > 1 else 0.0,
        "rest": float(np.std(rest[inside])),
        "offset": float(np.median(delay[cycle == 0])),
    }
    return found.assign(cycle=cycle, curve=delay - rest - cycle * period), numbers


def _comb(delay: Column, basis: Column, period: float, first: float) -> tuple[Column, Column]:
    """Cycle of each placement, and what is left, for one spacing and one beginning."""
    curve = np.array([np.median(delay) + first, 0.0, 0.0])
    for _ in range(12):
        left = delay - basis @ curve
        cycle = np.round(left / period)
        rest = left - cycle * period
        inside = np.abs(rest) < 9
        curve = curve + np.linalg.lstsq(basis[inside], rest[inside], rcond=None)[0]
    return cycle, rest


def reach(
    target: Target, distances: Column, random: np.random.Generator, sensor: Sensor | None = None
) -> float:
    """Greatest of the distances [m] from where on nearer ones are all told right in four of five readings."""
    repeated = np.repeat(distances, 25)
    scene = Scene(repeated, temperature=16.5, relative_humidity=0.32, target=target)
    delay = measure(scene, sensor, random).delay
    right = (np.abs(delay) < 0.5e-3).reshape(-1, 25).mean(axis=1) >= 0.8
    return float(distances[max(int((~right).argmax()) - 1, 0)] if not right.all() else distances[-1])


def angle_of_an_edge(distance: float, random: np.random.Generator, sensor: Sensor | None = None) -> float:
    """Angle off the axis [degree] at which the edge of a parallel panel, 61 x 122 cm, is still told."""
    edges = np.linspace(0.0, 0.6, 61) * distance
    told = [_sees_edge(distance, float(edge), random, sensor) for edge in edges]
    last = int(np.argmin(told)) - 1 if not all(told) else len(edges) - 1
    return float(np.degrees(np.arctan2(edges[max(last, 0)], distance)))


def _sees_edge(distance: float, edge: float, random: np.random.Generator, sensor: Sensor | None) -> bool:
    panel = Target(half_width=0.305, half_height=0.61, offset=edge + 0.305)
    scene = Scene(np.full(25, distance), temperature=16.5, relative_humidity=0.32, target=panel)
    return bool((np.abs(measure(scene, sensor, random).delay) < 0.5e-3).mean() >= 0.8)

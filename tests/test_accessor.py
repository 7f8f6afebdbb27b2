"""``df.echocal`` and ``ds.echocal``: the functions of the package, whatever was imported first."""

import inspect
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import echocal
from echocal.accessor import Accessor

MODEL = echocal.Model("linear", {"zero_error": {"offset": 8e-3}})
METHODS = [name for name in vars(Accessor) if not name.startswith("_")]

ORDERS = {
    "pandas before": "import pandas as pd; import echocal",
    "pandas after": "import echocal; import pandas as pd",
    "pandas after all names": "from echocal import *; import pandas as pd",
    "pandas looked for before": "import echocal, importlib.util\n"
    "importlib.util.find_spec('pandas')\nimport pandas as pd",
    "pandas by xarray": "import echocal, xarray; import pandas as pd",
}


@pytest.mark.parametrize("order", ORDERS)
def test_the_accessor_is_there_in_every_order(order: str) -> None:
    program = f"{ORDERS[order]}\nassert pd.DataFrame({{'a': [1]}}).echocal.correct"
    program += "\nimport xarray as xr; assert xr.Dataset().echocal.correct"
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True)
    assert not done.returncode, done.stderr


def test_a_method_is_the_function_of_the_table(random: np.random.Generator) -> None:
    distance = np.tile([0.5, 1.0, 2.0], 20)
    celsius = random.uniform(5.0, 35.0, 60)
    reading = MODEL.indicate(distance, temperature=celsius) + random.normal(0.0, 1e-4, 60)
    table = pd.DataFrame({"reading_m": reading, "temperature_C": celsius, "distance_m": distance})
    dataset = xr.Dataset.from_dataframe(table)
    corrected = echocal.correct(table, MODEL)
    pd.testing.assert_frame_equal(table.echocal.correct(MODEL).table, corrected.table)
    xr.testing.assert_identical(dataset.echocal.correct(MODEL).table, echocal.correct(dataset, MODEL).table)
    fitted = table.echocal.calibrate(echocal.Model("linear"), ["zero_error"])
    assert fitted.to_dict() == echocal.calibrate(table, echocal.Model("linear"), ["zero_error"]).to_dict()
    assert table.echocal.verify(maximum_permissible_error=0.02).passed
    assert len(table.echocal.read_observations()) == 60
    stated = {"thermometer": "DHT22"}
    found = table.echocal.budget(MODEL, uncertainties=stated, trials=0)
    assert found.to_dict() == echocal.budget(MODEL, table, uncertainties=stated, trials=0).to_dict()
    assert table.echocal.diagnose(base="linear").verdict == echocal.diagnose(table, base="linear").verdict


@pytest.mark.parametrize("name", METHODS)
def test_a_method_has_the_signature_and_the_help_of_the_function(name: str) -> None:
    function = getattr(echocal, name)
    own = list(inspect.signature(function).parameters.values())
    del own[1 if name == "budget" else 0]  # the table
    method = getattr(pd.DataFrame().echocal, name)
    assert list(inspect.signature(method).parameters.values()) == own
    assert inspect.getdoc(method) == inspect.getdoc(function)

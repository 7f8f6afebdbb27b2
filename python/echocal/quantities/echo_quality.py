"""Quality number of an echo, as the ranger or its logger gives it."""

from echocal.quantities.facts import QuantityFacts
from echocal.quantities.form import Form
from echocal.quantities.units import NUMBER

FACTS = QuantityFacts(
    id="echo_quality",
    words="echo quality",
    example=190.0,
    forms=(Form("echo_quality", "echo_quality", NUMBER, (), holds="quality number of the echo, in no unit"),),
    suspect="soft, wet or rough ground",
    why_no_codes="no codes of an echo's quality are defined",
)

"""The whole diagnosis on one screen: each stage takes the results of the stages before it.

Two stages can repeat. After each new level step, the columns are built again. If the
variance of autocorrelated noise may grow with the distance, the posterior is computed again.
"""

import warnings
from dataclasses import dataclass, replace

from echocal.diagnose.blas import one_thread
from echocal.diagnose.experiment_design.members import members
from echocal.diagnose.experiment_design.next_measurements import propose
from echocal.diagnose.faults import find_faults
from echocal.diagnose.garbage import no_cycle_search
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.examine import examine
from echocal.diagnose.inference.hypothesis import Stack
from echocal.diagnose.inference.posterior import Inference, infer
from echocal.diagnose.inference.weigh_steps import weigh_steps
from echocal.diagnose.matters import Matters
from echocal.diagnose.noises.common.convection import convections
from echocal.diagnose.noises.common.growing import NOISE_GROWTH, growth_of, with_growing_noise
from echocal.diagnose.noises.common.offsets import without_offsets, without_rows_off
from echocal.diagnose.noises.common.posterior import NoisePosterior, infer_noises
from echocal.diagnose.noises.common.scattered_rows import without_scattered_rows
from echocal.diagnose.noises.registry import not_imitated
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.hold_out import split
from echocal.diagnose.preprocess.moving import moving_target
from echocal.diagnose.preprocess.prepare import prepare
from echocal.diagnose.preprocess.reading import Reading
from echocal.diagnose.preprocess.reference import refuse_contradiction
from echocal.diagnose.preprocess.window import between
from echocal.diagnose.progress import Steps
from echocal.diagnose.request import Request
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.diagnose.results.outlier_rules import outlier_rules, unmet
from echocal.diagnose.results.report import report
from echocal.diagnose.selection.claims import Ranking, rank
from echocal.diagnose.selection.joint import join
from echocal.diagnose.selection.plausibility import implausible
from echocal.diagnose.selection.select import Selection, select
from echocal.diagnose.selection.unexplained_term import imitated
from echocal.diagnose.validation.held_rows import held_rows
from echocal.diagnose.validation.judges import judge_of
from echocal.diagnose.validation.remainder import remainder
from echocal.diagnose.validation.smooth import smooth_correction
from echocal.diagnose.validation.unconfirmed import unconfirmed
from echocal.diagnose.validation.validate import validate
from echocal.errors import DataError, DomainWarning
from echocal.observations.checks import still_refused

__all__ = ["Examined", "examined", "run"]

_CONSIDERED = 1e-3  # probability beside some set from which on the folds consider a noise, too
_MOST_LEVEL_STEPS = 6  # repetitions, each with a further step of the level


@dataclass(frozen=True)
class Examined:
    """A diagnosis with the inference that it comes from, for a pool of several tables.

    Attributes
    ----------
    diagnosis : Diagnosis
    case : Case
    reduced : Stack
        Products under the noise models that some hypothesis makes probable.
    shares : NoisePosterior
    ranking : Ranking
    selection : Selection
    """

    diagnosis: Diagnosis
    case: Case
    reduced: Stack
    shares: NoisePosterior
    ranking: Ranking
    selection: Selection


def run(reading: Reading, request: Request, work: Steps) -> Diagnosis:
    """Diagnose a table; see `examined`."""
    return examined(reading, request, work).diagnosis


@one_thread()
@no_cycle_search()
def examined(reading: Reading, request: Request, work: Steps) -> Examined:
    """Diagnose a table, and keep the inference.

    Parameters
    ----------
    reading : Reading
    request : Request
    work : Steps
        Receives the name of each stage as it begins.

    Returns
    -------
    Examined
        The diagnosis is without the seconds that it took.

    Raises
    ------
    DataError
        If the table has too few usable rows.
    UsageError
        If the request contradicts the table.
    """
    settings = request.settings
    base, distance, constant = request.base, request.reference_distance, request.constant_distance
    with warnings.catch_warnings(action="ignore", category=DomainWarning):  # the final one is a note
        work.begin("searching for faults")
        whole = between(reading.observations, request.since, request.until)
        refuse_contradiction(whole, distance, constant)
        after = request.hold_out_after
        read, _ = split(whole, after, settings.rows.fewest)
        faults = find_faults(read, base.assumed, distance, constant, settings)
        if reading.refusal is not None and not faults.explain_a_refusal:
            raise reading.refusal
        if why := still_refused(faults.observations):  # a repair of one column hides no other one
            raise DataError(why)
        columns = {found.cause for found in faults.accepted if found.facts.kind == "gross"}
        held = None if after is None else held_rows(whole, after, base, distance, constant, settings, columns)
        observations = faults.observations
        ranges = request.ranges(list(observations.conditions))
        level_steps: list[int] = []
        while True:
            work.begin("building columns")
            table = prepare(
                observations, base, distance, constant, settings.rows, level_steps, faults.rounding
            )
            moving = moving_target(table, settings.rows, distance)
            steps = weigh_steps(table, base, request.seed, settings, level_steps)
            table = table if steps is None else steps.kept(steps.case.folds.fit)
            folds = Folds.of(table, settings.rows)
            case = examine(table, base, folds, request.seed, settings)

            work.begin("comparing causes")
            case, inference, offsets = without_offsets(case, infer(case))
            case, inference = _with_convection(case, inference)

            work.begin("comparing noises")
            tried = not_imitated(faults.quantizations)
            if moving:  # far readings vary more only because the target went there
                case = replace(case, moving=moving)
                tried = tuple(noise for noise in tried if noise.facts.id != NOISE_GROWTH)
            shares = infer_noises(case, inference.fits, inference.reduced, tried)
            if (grown := with_growing_noise(case, inference, shares)) is not None:
                case, inference = grown
                tried = tuple(noise for noise in tried if noise.facts.id != NOISE_GROWTH)
                shares = infer_noises(case, inference.fits, inference.reduced, tried)
            elif off := without_rows_off(case, inference, shares, tried):
                less, noise = off
                case, inference = _with_convection(less.case, less.inference)
                tried = tuple(other for other in tried if other is not noise)
                shares = infer_noises(case, inference.fits, inference.reduced, tried)
                offsets.append(less.finding)
            elif (scattered := without_scattered_rows(case, inference, shares)) is not None:
                case, inference = _with_convection(*scattered)
                shares = infer_noises(case, inference.fits, inference.reduced, tried)
            if grows := growth_of(case, inference):
                offsets.append(grows)
            reduced = inference.reduced
            ranking = rank(shares.fits, case.found.competing, settings)

            work.begin("validating claims")
            selection = select(case, ranking, shares, reduced)
            possible = shares.possible(_CONSIDERED)
            judge = judge_of(case, reduced.noises, possible, held, after, steps)
            validation = validate(case, selection, judge, reduced)
            step = validation.further_level_step(case.table)
            if step is None or len(level_steps) == _MOST_LEVEL_STEPS:
                break
            level_steps.append(step)
            work.level_steps = len(level_steps)

        doubts = imitated(validation.kept, ranking) | unconfirmed(case, validation, judge, selection.noise)
        doubts |= implausible(validation.kept, ranking)
        validation = replace(validation, doubts={**validation.doubts, **doubts})
        smooth = smooth_correction(case, validation, judge, selection.noise)
        left = remainder(case, ranking, validation, smooth, selection.noise)

        work.begin("planning measurements")
        joint = join(ranking, [*faults.found, *offsets], shares, reduced)
        able = members(case, ranking, selection.claims, validation, reduced)
        proposals = propose(case, able, selection, validation, ranges)
        found = (inference, ranking, selection, validation, judge, joint, smooth, left)
        matters = Matters.of(case, request.matters_mm)
        diagnosis = report(case, observations, *found, able, proposals, matters)
        reference = whole.reference_distance if distance is None and not constant else None
        own = (read, reference, diagnosis.fates, diagnosis.model)
        more = [] if columns else outlier_rules(*own, settings)
        left_out = [] if columns else unmet(*own, faults.rules(more))
        known = {**diagnosis.model.provenance, **faults.marks(more, left_out)}
        diagnosis = replace(diagnosis, model=diagnosis.model.with_provenance(known))
    work.end()
    return Examined(diagnosis, case, reduced, shares, ranking, selection)


def _with_convection(case: Case, inference: Inference) -> tuple[Case, Inference]:
    """The posterior once more, if noise whose variance grows with the distance may be there."""
    growing = convections(case, inference.fits, inference.reduced)
    if not growing:
        return case, inference
    case = case.with_correlations(growing)
    del inference  # it is large for a wide table
    return case, infer(case)

"""Work of one case: its values to its record, whatever it raises."""

from __future__ import annotations

import math
import time
import warnings

from lumped.errors import LawRangeWarning, ParameterError, SpurcheckError
from validation.studies.analyses import Evaluator
from validation.studies.axes import AxisValue
from validation.studies.record import MAX_MESSAGE, Record, Status


def evaluate(evaluator: Evaluator, case: int, values: tuple[AxisValue, ...]) -> Record:
    """Evaluate one case; whatever it raises becomes its record."""
    start = time.perf_counter()

    def record(status: Status, outputs: tuple[float, ...] = (), message: str = "") -> Record:
        return Record(case, status, time.perf_counter() - start, outputs, message[:MAX_MESSAGE])

    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            outputs = evaluator(values)
    except ParameterError as error:
        return record(Status.REFUSED, message=str(error))
    except SpurcheckError as error:
        return record(Status.NUMERICAL, message=f"{type(error).__name__}: {error}")
    except Exception as error:  # noqa: BLE001  (a defect in one case must not end the other cases)
        return record(Status.UNEXPECTED, message=f"{type(error).__name__}: {error}")
    bad = [name for name, x in zip(evaluator.outputs, outputs, strict=True) if not math.isfinite(x)]
    if bad:
        return record(Status.NUMERICAL, message="not finite: " + ", ".join(bad))
    outside = [str(w.message) for w in caught if issubclass(w.category, LawRangeWarning)]
    if outside:
        return record(Status.OUTSIDE_LAW_RANGE, outputs, outside[0])
    return record(Status.OK, outputs)

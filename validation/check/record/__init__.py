"""A measured record beside the prediction, with the uncertainties of record, inputs and numerics."""

from validation.check.record.channel import ChannelComparison, PeakToPeak, Record
from validation.check.record.compare import compare_record
from validation.check.record.comparison import RecordComparison

__all__ = ["ChannelComparison", "PeakToPeak", "Record", "RecordComparison", "compare_record"]

"""A measured record beside the prediction, with the uncertainties of record, inputs and numerics."""

from validation.check.record.all_channels import RecordComparison
from validation.check.record.channel_comparison import ChannelComparison, PeakToPeak, Record
from validation.check.record.comparing import compare_record

__all__ = ["ChannelComparison", "PeakToPeak", "Record", "RecordComparison", "compare_record"]

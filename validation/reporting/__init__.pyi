from .build import Report as Report
from .build import report as report

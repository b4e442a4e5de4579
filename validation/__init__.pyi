from .cross_check.comparison import CrossCheck as CrossCheck
from .cross_check.comparison import crosscheck as crosscheck
from .interactive import write_interactive_page as write_interactive_page
from .plots.of_result import plot as plot
from .reporting import Report as Report
from .reporting import report as report
from .validity.flags import Flag as Flag
from .validity.flags import validity_flags as validity_flags

"""The subcommands of ``spurcheck``, one module each.

Nothing here imports the numerics at module level: ``spurcheck --help`` must answer at once.
"""

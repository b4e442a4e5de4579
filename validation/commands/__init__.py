"""The subcommands of ``spurcheck``.

Nothing here imports the numerics at module level: ``spurcheck --help`` must answer at once.
"""

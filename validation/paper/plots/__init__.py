"""Pictures of the paper's figures, drawn from the data of ``validation.paper.figures``."""

"""Public reference cases: gear pairs and equations with curves beside which another model can be laid."""

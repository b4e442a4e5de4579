"""Statements of Vaishya and Singh on sliding friction in gear dynamics, judged by numbers."""
